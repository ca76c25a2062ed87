"""Things by name: a duplicate is an error, an unknown name is answered with the closest match."""

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Generic, TypeVar

from executive.core.errors import InputError

T = TypeVar("T")
_MOST_LISTED, _NEAREST = 50, 8


def closest(name: str, known: list[str]) -> str:
    """Return `did you mean 'x'? (known: ...)` for a message about an unknown name.

    Without a match only the known names are left: `known: ...`. Of very many, some are named.
    """
    import difflib  # only for those who mistype

    match = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    names, more = sorted({*known}), ""
    if len(names) > _MOST_LISTED:
        near = difflib.get_close_matches(name, names, n=_NEAREST, cutoff=0.3)
        more = f" and {len(names) - len(near or names[:_NEAREST])} more"
        names = sorted(near) or names[:_NEAREST]
    listed = f"known: {', '.join(names) or 'none'}{more}"
    return f"did you mean {match[0]!r}? ({listed})" if match else listed


class Registry(Generic[T]):
    """A named set of things of one kind."""

    def __init__(self, kind: str) -> None:
        """Start empty; `kind` names the things in messages, e.g. `skill`."""
        self.kind = kind
        self._things: dict[str, T] = {}

    def add(self, name: str, thing: T) -> T:
        """Add a thing under a name that is not taken.

        Raises:
            ValueError: The name is taken by another thing.
        """
        if name in self._things:
            raise ValueError(f"{self.kind} {name!r} is registered twice")
        self._things[name] = thing
        return thing

    def get(self, name: str) -> T:
        """Return the thing of that name.

        Raises:
            InputError: There is none.
        """
        try:
            return self._things[name]
        except KeyError:
            raise InputError(
                f"unknown {self.kind} {name!r}; {closest(name, list(self._things))}"
            ) from None

    def __contains__(self, name: object) -> bool:
        return name in self._things

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._things))

    def __len__(self) -> int:
        return len(self._things)


class LazyRegistry(Registry[T]):
    """Things that are imported when they are asked for: a tree loads only what it uses."""

    def __init__(self, kind: str, places: Mapping[str, str]) -> None:
        """Know where each thing is: `package.module:Name` by name."""
        super().__init__(kind)
        self._places = dict(places)

    def add(self, name: str, thing: T) -> T:
        """Add a thing under a name that is not taken.

        Raises:
            ValueError: The name is taken by another thing.
        """
        if name in self._places:
            raise ValueError(f"{self.kind} {name!r} is registered twice")
        return super().add(name, thing)

    def get(self, name: str) -> T:
        """Return the thing of that name, imported if need be.

        Raises:
            InputError: There is none.
        """
        if name in self._places and name not in self._things:
            module, _, attribute = self._places[name].partition(":")
            self._things[name] = getattr(import_module(module), attribute)
        if name not in self._things:
            raise InputError(f"unknown {self.kind} {name!r}; {closest(name, [*self])}")
        return self._things[name]

    def __contains__(self, name: object) -> bool:
        return name in self._places or super().__contains__(name)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted({*self._places, *self._things}))

    def __len__(self) -> int:
        return len({*self._places, *self._things})
