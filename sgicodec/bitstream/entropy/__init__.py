"""Symbols to bytes and back: range coder, frequency tables."""
