"""Published figures and tables computed anew, with the errata of the papers beside the numbers they concern."""

from trunnion.reproduction.reproduce import reproduce
from trunnion.reproduction.result import Comparison, Conclusion, PaperFigure, Reproduction, Row

__all__ = ["Comparison", "Conclusion", "PaperFigure", "Reproduction", "Row", "reproduce"]
