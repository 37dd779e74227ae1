"""Dataclasses from JSON and into JSON.

The types of a dataclass's fields are its schema: numbers, texts, tuples and dataclasses are read as such, lists of numbers become
numpy arrays. A field has its own name in the JSON, or the place that `At` gives. `tests/test_contract.py` compares the classes
with api/openapi.yaml.
"""

from __future__ import annotations

import collections.abc
import dataclasses
import functools
import operator
from dataclasses import dataclass
from typing import (
    Annotated,
    Any,
    Callable,
    ClassVar,
    Dict,
    Iterable,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Type,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from .units import Quantity, without_unit

Decoded = TypeVar("Decoded")
Read = Callable[[Any], Any]
REQUIRED: Any = object()
"""The default of a field that has none."""


@dataclass(frozen=True)
class At:
    """The place of a field in the JSON of its class.

    Attributes:
        pointer: JSON pointer, to which the field's name is added if it ends in "/". "/states/*/stress" is the list of the member
            `stress` of all entries of `states`, and "" the whole document.
        missing: value of the field if the JSON lacks it or has null; by default that of the dataclass, or None.
        read: function that makes the value from its JSON; None for the one of the field's type.
        write: function that makes the JSON of a value, from the value and the field's name.
        sent: whether the field is part of the JSON at all.
    """

    pointer: str = "/"
    missing: Any = REQUIRED
    read: Optional[Read] = None
    write: Optional[Callable[[Any, str], Any]] = None
    sent: bool = True

    def parts(self, name: str) -> List[str]:
        """The members on the way to the field called `name`."""
        return (self.pointer + name if self.pointer.endswith("/") else self.pointer).split("/")[1:]


ACCURACY = At("/accuracy/")
EFFECT = At("/effects/")
LOCAL = At(sent=False)
"""The mark of a field that is not part of the JSON."""


class Shape:
    """The shape of an array, with -1 for any length."""

    def __init__(self, *sizes: int) -> None:
        self.sizes = sizes

    def __str__(self) -> str:
        names = iter("nmk")
        sizes = [next(names) if size < 0 else str(size) for size in self.sizes]
        return f"({', '.join(sizes)}{',' if len(sizes) == 1 else ''})"


class Member(NamedTuple):
    """A field of a dataclass as a member of its JSON: its name, its type without marks, its place, its shape, its default and the
    dimensions of which its unit may be, if it may have one."""

    name: str
    hint: Any
    at: At
    shape: Optional[Shape]
    default: Any
    dimensions: Tuple[str, ...]


@functools.lru_cache(maxsize=None)
def fields_of(kind: Any) -> Tuple[Member, ...]:
    hints = get_type_hints(kind, include_extras=True)
    return tuple(_field(one, hints[one.name]) for one in dataclasses.fields(kind))


def _field(one: "dataclasses.Field[Any]", hint: Any) -> Member:
    hint, marks = _without_marks(hint)
    inner = [mark for argument in get_args(hint) for mark in _without_marks(argument)[1]] if get_origin(hint) is Union else []
    default = REQUIRED if one.default is dataclasses.MISSING else one.default
    if one.default_factory is not dataclasses.MISSING:
        default = one.default_factory()
    at = next((mark for mark in marks if isinstance(mark, At)), At())
    shape = next((mark for mark in (*marks, *inner) if isinstance(mark, Shape)), None)
    dimensions = next((mark.dimensions for mark in marks if isinstance(mark, Quantity)), ())
    return Member(one.name, hint, at, shape, default, dimensions)


def _without_marks(hint: Any) -> Tuple[Any, Tuple[Any, ...]]:
    return (hint.__origin__, hint.__metadata__) if get_origin(hint) is Annotated else (hint, ())


def decode(kind: Type[Decoded], document: Any) -> Decoded:
    """The JSON as a value of a dataclass, or of another type that a field may have."""
    return decode_all(kind, [document])[0]


def decode_all(kind: Type[Decoded], documents: Iterable[Any]) -> List[Decoded]:
    """Several documents of the same type."""
    hint: Any = kind
    return list(map(_reader(hint), documents))


def by_name(member: str, key: str = "name") -> Read:
    """Reads a list of objects as a dictionary of one of their members, by their names."""
    return lambda entries: {entry[key]: entry[member] for entry in entries}


@functools.lru_cache(maxsize=None)
def _reader(hint: Any) -> Read:
    """The function that reads a type. The functions for the fields of a dataclass are looked up once, not for each object."""
    hint, marks = _without_marks(hint)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is np.ndarray:
        return _array_reader(get_args(arguments[1])[0], next((mark for mark in marks if isinstance(mark, Shape)), None))
    if origin is Union and len(arguments) == 2 and type(None) in arguments:
        read_present = _reader(next(one for one in arguments if one is not type(None)))
        return lambda value: None if value is None else read_present(value)
    if origin is tuple:
        read_entry = _reader(arguments[0])
        return lambda values: tuple(map(read_entry, values))
    if origin in (dict, collections.abc.Mapping):
        return dict
    if hint in (float, int, bool, str):
        return hint  # type: ignore[no-any-return]
    if dataclasses.is_dataclass(hint):
        return _object_reader(hint)
    raise TypeError(f"{hint} cannot be read from JSON")


def _array_reader(dtype: Any, shape: Optional[Shape]) -> Read:
    """Reads an array. Null is nan in an array of floats, and -1 in one of indices."""
    holds_indices = np.issubdtype(dtype, np.integer)

    def read(values: Any) -> Any:
        if holds_indices and None in values:
            values = [-1 if value is None else value for value in values]
        array = np.asarray(values, dtype=dtype)
        return array if shape is None else array.reshape(shape.sizes)

    return read


def _object_reader(kind: Any) -> Read:
    """Reads a dataclass by a call of its constructor that is written as source, as `dataclasses` writes the constructor. Large
    answers have many small objects, for which a loop over the fields would be slower."""
    scope: Dict[str, Any] = {"kind": kind}
    arguments = []
    for field in fields_of(kind):
        read, missing, parts = _present_reader(field), _missing(field), field.at.parts(field.name)
        scope.update({f"read_{field.name}": read, f"missing_{field.name}": missing})
        if field.at.sent and len(parts) == 1 and parts[0] != "*":
            found = f"document[{parts[0]!r}]" if missing is REQUIRED else f"document.get({parts[0]!r})"
        else:
            found, scope[f"find_{field.name}"] = f"find_{field.name}(document)", _finder(field)
        shown = f"{read.__name__ if read in (int, bool, str) else f'read_{field.name}'}({{}})"
        present = shown.format("value")
        arguments.append(shown.format(found) if missing is REQUIRED else
                         f"missing_{field.name} if (value := {found}) is None else {present}")
    return cast(Read, eval(f"lambda document: kind({', '.join(arguments)})", scope))


def _present_reader(field: Member) -> Read:
    """The function that reads the value of a field that is neither missing nor null."""
    hint = field.hint
    if get_origin(hint) is Union:
        hint = next(one for one in get_args(hint) if one is not type(None))
    return field.at.read or _reader(hint if field.shape is None else Annotated[hint, field.shape])


def _missing(field: Member) -> Any:
    """The value of a field that a document lacks; REQUIRED if that is a fault."""
    if field.at.missing is not REQUIRED:
        return field.at.missing
    optional = get_origin(field.hint) is Union and type(None) in get_args(field.hint)
    return None if optional and field.default is REQUIRED else field.default


def _finder(field: Member) -> Read:
    """The function that finds a field in a document. It returns None if the document lacks one that is not required."""
    return _find(field.at.parts(field.name), _missing(field) is REQUIRED) if field.at.sent else lambda document: None


def _find(parts: Sequence[str], required: bool) -> Read:
    if not parts:
        return lambda document: document
    first, rest = parts[0], _find(parts[1:], required and parts[0] != "*")
    if first == "*":
        return lambda entries: None if entries is None else list(map(rest, entries))
    if required:
        return lambda document: rest(document[first])
    if len(parts) == 1:
        return operator.methodcaller("get", first)
    return lambda document: None if (inner := document.get(first)) is None else rest(inner)


class Sent:
    """A dataclass that becomes JSON. `class Shell(Sent, kind="shell")` has the constant member `kind` in its JSON."""

    _constants: ClassVar[Mapping[str, Any]] = {}

    def __post_init__(self) -> None:
        """Replaces texts with units by numbers. Raises `ValueError`."""
        kind: Any = type(self)
        for field in fields_of(kind):
            if field.dimensions:
                value = without_unit(getattr(self, field.name), field.name, field.dimensions)
                object.__setattr__(self, field.name, value)

    def __init_subclass__(cls, **constants: Any) -> None:
        super().__init_subclass__()
        if constants:
            cls._constants = constants

    def to_wire(self) -> Dict[str, Any]:
        """The JSON. None is not sent, nor a flag, a list or a dictionary that is left at its default: it is left to the server."""
        document = dict(self._constants)
        kind: Any = type(self)
        for field in fields_of(kind):
            value = getattr(self, field.name)
            if field.at.sent and value is not None and not _is_left_to_the_server(value, field.default):
                _put(document, field.at.parts(field.name), _written(value, field))
        return document


def _is_left_to_the_server(value: Any, default: Any) -> bool:
    if isinstance(default, bool):
        return value is default
    return isinstance(default, (tuple, dict)) and len(default) == 0 and len(value) == 0


def _written(value: Any, field: Member) -> Any:
    if field.at.write is not None:
        return field.at.write(value, field.name)
    return encode(value) if field.shape is None else numbers(value, field.name, field.shape)


def _put(document: Dict[str, Any], parts: Sequence[str], value: Any) -> None:
    """Writes a value at a place; objects that already stand there get its members."""
    if parts:
        for part in reversed(parts):
            value = {part: value}
    for name, member in value.items():
        if isinstance(member, dict) and isinstance(document.get(name), dict):
            _put(document[name], (), member)
        else:
            document[name] = member


def encode(value: Any) -> Any:
    """The JSON of a value: of a `Sent`, an array, a dictionary, a sequence, or of anything that is JSON already."""
    if isinstance(value, Sent):
        return value.to_wire()
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, collections.abc.Mapping):
        return {name: encode(member) for name, member in value.items()}
    if isinstance(value, collections.abc.Iterable) and not isinstance(value, (str, bytes)):
        return [encode(entry) for entry in value]
    return value


def given(**fields: Any) -> Dict[str, Any]:
    """The JSON of those fields that are not None."""
    return {name: encode(value) for name, value in fields.items() if value is not None}


def numbers(value: Any, name: str, shape: Shape) -> Any:
    """Numbers of a shape as lists. Raises `ValueError` if they have another one."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != len(shape.sizes) or any(size not in (-1, own) for size, own in zip(shape.sizes, array.shape)):
        raise ValueError(f"{name} with the shape {array.shape}; expected {shape}")
    return array.tolist()


def integers(values: Any, name: str = "") -> List[int]:
    """Indices as a list."""
    return [int(value) for value in values]
