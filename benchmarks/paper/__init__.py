"""The paper's tables, measured again, with its published figures beside them."""
