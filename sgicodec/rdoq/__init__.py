"""Symbols after the fit: a search for those of least squared error plus price, with the tables that will code them.

A fit rounds every attribute by itself. Here each seed's symbols move one step at a time where the picture as drawn, all
other seeds in it, and the bits as coded say that it pays; the base layer's follow, and seeds that do not pay go.
docs/research.md, "Symbols after the fit", tells what each part gains.
"""

from sgicodec.rdoq.objective import Cost, Scene, can_refine
from sgicodec.rdoq.search import Refined, Refiner
from sgicodec.rdoq.settings import RefineSettings

__all__ = ["Cost", "RefineSettings", "Refined", "Refiner", "Scene", "can_refine"]
