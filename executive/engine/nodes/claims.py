"""Who holds what: two nodes of a tree can never command one arm."""

from collections.abc import Iterable

from executive.core.errors import ClaimError


class Claims:
    """What the running leaves of one tree have to themselves, by the path of the leaf."""

    def __init__(self) -> None:
        """Begin with everything free."""
        self._holders: dict[str, str] = {}
        self._waits: dict[str, str] = {}
        self._parallels: set[str] = set()

    def note_parallel(self, path: str) -> None:
        """Take note of a node whose children run at the same time."""
        self._parallels.add(path)

    def take(self, path: str, resources: Iterable[str]) -> bool:
        """Give a leaf all that it claims, or nothing.

        A reactive node starts what comes first before it halts what ran until then, so the
        newcomer finds its arm taken by a leaf that is stopped later in the same tick. It waits
        for that tick.

        Args:
            path: Path of the leaf.
            resources: What it claims.

        Returns:
            Whether it has them; if not, it is to ask again in the next tick.

        Raises:
            ClaimError: Another leaf has one of them, and is not about to be halted.
        """
        wanted = sorted(resources)
        for resource in wanted:
            holder = self._holders.get(resource, path)
            if holder != path:
                return self._wait(path, resource, holder)
        self._waits.pop(path, None)
        self._holders.update(dict.fromkeys(wanted, path))
        return True

    def release(self, path: str) -> None:
        """Take back whatever a leaf holds."""
        self._waits.pop(path, None)
        for resource in [name for name, holder in self._holders.items() if holder == path]:
            del self._holders[resource]

    def _wait(self, path: str, resource: str, holder: str) -> bool:
        if self._waits.get(path) != holder and _fork(path, holder) not in self._parallels:
            self._waits[path] = holder
            return False
        raise ClaimError(
            f"{path}: cannot start; {resource} is held by {holder}, which goes on; "
            "expected it to be free; try a sequence instead of a parallel"
        )


def _fork(path: str, other: str) -> str:
    """Return the path of the node below which two nodes part."""
    shared = []
    for one, two in zip(path.split("/"), other.split("/"), strict=False):
        if one != two:
            break
        shared.append(one)
    return "/".join(shared)
