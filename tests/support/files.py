"""What is in a folder."""

from pathlib import Path


def contents(folder: Path) -> dict[str, object]:
    """The bytes of every file below a folder, or where a link leads, by name."""
    found: dict[str, object] = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        found[name] = path.readlink() if path.is_symlink() else path.read_bytes() if path.is_file() else None
    return found
