"""What a report that is handed in says of itself: number, revision, who answers for it.

::

    [document]
    number = "TV-2031"
    revision = "B"
    author = "…"
"""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from trunnion.driveline.record import Name, Record


class TitleBlock(Record):
    """Title block of the report that is handed in (``tn.submission``); numbers of the line do not depend on it.

    Parameters
    ----------
    number : of the document.
    revision : of the document, "A" say.
    plant : what the line belongs to: ship and yard number, vehicle, mill.
    author, checked_by, approved_by : names in the signature block; lines to sign on stay empty without them.

    >>> TitleBlock(number="TV-2031", revision="B").revision
    'B'
    """

    what: ClassVar[str] = "document"
    example: ClassVar[str] = 'number = "TV-2031" and revision = "B"'

    number: Name | None = Field(default=None, description="of the document")
    revision: Name | None = Field(default=None, description="of the document")
    plant: Name | None = Field(default=None, description="ship and yard number, vehicle or mill")
    author: Name | None = Field(default=None, description="who computed it")
    checked_by: Name | None = Field(default=None, description="who checked it")
    approved_by: Name | None = Field(default=None, description="who released it")
