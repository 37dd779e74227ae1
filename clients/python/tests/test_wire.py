"""How documents become dataclasses: values have the types that the fields declare, and what cannot have them is refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import pytest

from supple.wire import decode


@dataclass
class Counted:
    count: int
    name: str
    most: Optional[int] = None


def test_numbers_become_what_the_fields_declare() -> None:
    found = decode(Counted, {"count": 3.0, "name": "a", "most": 2.0})
    assert (found.count, found.most) == (3, 2)
    assert isinstance(found.count, int) and isinstance(found.most, int)


def test_null_is_no_number() -> None:
    with pytest.raises(TypeError):
        decode(Counted, {"count": None, "name": "a"})


def test_a_field_that_a_document_lacks_has_its_default() -> None:
    assert decode(Counted, {"count": 1, "name": "a"}) == Counted(1, "a", None)
    with pytest.raises(KeyError):
        decode(Counted, {"name": "a"})
