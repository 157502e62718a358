"""RDOQ, rate-distortion optimised quantisation: symbols of least error plus λ times bits, as they will be coded.

A fit rounds every attribute by itself. Here each seed's symbols move one step at a time where the picture as rendered,
all other seeds in it, and the bits as coded say that it pays. docs/notes/2026-11-rdoq.md reports what each part gains.
"""

from sgicodec.rdoq.coordinate_descent import RdoqSettings, searched
from sgicodec.rdoq.objective import Objective

__all__ = ["Objective", "RdoqSettings", "searched"]
