"""The rules of the layout: which file may import which, how large files and functions may be.

Each rule is a function from a :class:`Tree` to sentences that name the places where it is broken. CONTRIBUTING.md
explains the rules.
"""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

ABOVE_BODIES = tuple(
    f"model/{name}.py"
    for name in (
        "__init__",
        "acting",
        "assessment",
        "case",
        "crack",
        "doubts",
        "history",
        "keys",
        "points",
        "problem",
        "recorded",
        "strength",
        "units",
    )
)
"""The upper floor of model/, which knows the bodies. The bodies know the lower floor: checks, materials, loads."""

LEVELS = (
    ("runtime",),
    ("kernels",),
    ("model",),
    ("bodies",),
    ABOVE_BODIES,
    ("lugs", "tables"),
    ("elasticity", "casefile"),
    ("reading",),
    ("states",),
    ("solver", "damage", "cracks"),
    ("narrow", "drift", "joints"),
    ("wear_lives",),
    ("sessions", "verification", "storage"),
    ("assess",),
    ("studies", "charts"),
    ("report",),
    ("figures",),
    ("published", "pages", "live"),
    ("cli",),
)

RANKS = {folder: rank for rank, level in enumerate(LEVELS) for folder in level if level != ABOVE_BODIES}
"""Every folder and its rank. A file imports from its own folder and from lower ranks."""

CORE = ("runtime", "kernels", "model", "bodies", "elasticity", "reading", "states", "solver")
"""The folders that a solution needs."""

WINGS = ("lugs", "tables", "narrow", "drift")
"""Folders that few solutions need. The core imports no file of theirs."""

ROOT_FILES = ("errors", "version")
"""Files of rank 0, beside the folders."""

HOMES = {
    "numba": ("runtime",),
    "llvmlite": ("runtime",),
    "ctypes": ("runtime",),
    "matplotlib": ("figures", "published"),
    "h5py": ("storage",),
    "tomllib": ("casefile",),
    "sqlite3": ("storage", "studies"),
    "multiprocessing": ("studies",),
    "argparse": ("cli",),
    "tqdm": ("cli",),
    "jinja2": ("pages",),
    "typst": ("pages",),
    "shtab": ("cli",),
    "aiohttp": ("live",),
    "ezdxf": ("lugs",),
}
"""Packages that only some folders may import."""

PRINTS = "cli/terminal.py"
"""The only file that calls ``print``: its ``say`` escapes all that could steer a terminal."""

OUTPUTS = ("assess", "report", "figures", "pages", "live", "cli")
"""Folders that show numbers to people. Their units come from ``units``, with the thickness of a problem."""

OPTIONAL = ("ezdxf", "xarray", "pandas", "pylife", "distributed", "shtab", "typst")
"""Packages that may be missing. They are imported inside functions."""

BY_NAME = ("import_module", "__import__", "Later")
"""Functions that import a module whose name is a text."""

MOST_LINES = 600
MOST_FUNCTION_LINES = 50
MOST_PARAMETERS = 8
MOST_PUBLIC_NAMES = 45

UPWARD = {
    "bodies/compliance.py": "the stress away from the hole takes integrals, which few plates need",
    "elasticity/build.py": "an operator without stored entries is for grids of many unequal distances",
    "model/history.py": "LoadHistory is read from a CSV file, which few histories are",
    "model/profile.py": "Profile is read from a CSV file, which few profiles are",
    "states/state.py": "State shows itself in notebooks",
    "wear_lives/wear_result.py": "WearResult words itself as a table",
    "solver/first_contact.py": "few first contacts are found on a window",
    "solver/path_stepper.py": "the friction changes along few steps",
    "solver/result.py": "Result plots, reports, saves and shows itself, and has its fatigue computed",
    "solver/run.py": "few grids are followed on windows",
    "solver/task.py": "few contacts are too narrow for equally spaced nodes",
}
"""Files that call public faces, of fastpin or of other folders, inside functions, and why."""

LOCAL_IMPORTS = {"cli/progress.py": "tqdm takes 60 ms, and a refused option needs no progress bar"}
"""Files that import other packages inside functions, and why."""

MANY_PARAMETERS: dict[str, str] = {
    "model/problem.py Problem.from_load_parameter": "the fields of a problem",
    "damage/spectrum.py spectrum_damage": "the choices of a count are spelt out for help and completion",
    "solver/solving.py solve": "the options are spelt out for help and completion",
    "studies/convergence.py converge": "the choices of a study are spelt out for help and completion",
    "storage/recording.py record": "the arguments of solve, and three of the file",
    "storage/wear_files.py wear": "the arguments of solve, those of wear, and five of the file",
}
"""Functions of more parameters, and why."""


@dataclass(frozen=True)
class Import:
    """One imported name: the file, the line, the module and the name (empty for ``import module``)."""

    file: str
    line: int
    module: str
    name: str
    inside: bool


class Source:
    """A file, parsed, and the answers of all its nodes to the rules. The trees of the tests share most files."""

    def __init__(self, text: str) -> None:
        self.tree = ast.parse(text)
        self.lines = len(text.splitlines())
        nodes = list(ast.walk(self.tree))
        inside = {
            line
            for node in nodes
            if isinstance(node, ast.FunctionDef)
            for line in range(node.lineno, (node.end_lineno or 0) + 1)
        }
        self.imports: list[tuple[int, str, str, bool]] = []
        """Line, module, name and whether a function holds it, of each imported name."""
        for node in nodes:
            if isinstance(node, ast.Import):
                self.imports += [(node.lineno, alias.name, "", node.lineno in inside) for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                module = "." * node.level + (node.module or "")
                self.imports += [(node.lineno, module, alias.name, node.lineno in inside) for alias in node.names]
        calls = [node for node in nodes if isinstance(node, ast.Call) and node.args]
        self.named = [
            (node.lineno, text.value, text is node.args[0])
            for node in calls
            if getattr(node.func, "attr", getattr(node.func, "id", "")) in BY_NAME
            for text in ast.walk(node.args[0])
            if isinstance(text, ast.Constant) and isinstance(text.value, str)
        ]
        """Line, text and whether it is the whole name, of each import by a name in a text."""
        self.prints = [
            node.lineno for node in nodes if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "print"
        ]
        self.private = [
            (node.lineno, getattr(node.value, "id", ""), node.attr)
            for node in nodes
            if isinstance(node, ast.Attribute) and node.attr.startswith("_")
        ]
        """Line, owner and name of each attribute with an underscore."""

    @cached_property
    def functions(self) -> list[tuple[str, ast.FunctionDef]]:
        """Every function with its name, such as ``Run.follow``."""
        found = []
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef):
                found.append((node.name, node))
            elif isinstance(node, ast.ClassDef):
                methods = (inner for inner in node.body if isinstance(inner, ast.FunctionDef))
                found += [(f"{node.name}.{inner.name}", inner) for inner in methods]
        return found

    @cached_property
    def compiled(self) -> dict[str, ast.FunctionDef]:
        """The compiled functions by name."""
        return {
            node.name: node
            for node in self.tree.body
            if isinstance(node, ast.FunctionDef)
            and any(isinstance(mark, ast.Name) and mark.id in ("compiled", "inner") for mark in node.decorator_list)
        }

    @cached_property
    def called(self) -> list[tuple[int, str, str]]:
        """Line, compiled function and called name of each call of a name in a compiled function."""
        return [
            (node.lineno, name, node.func.id)
            for name, function in self.compiled.items()
            for node in ast.walk(function)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        ]


@lru_cache(maxsize=1000)
def _source(text: str) -> Source:
    return Source(text)


def texts_of(root: Path) -> dict[str, str]:
    """The text of each file of the package, by its name in it. `root` is the folder that holds ``fastpin/``."""
    package = root / "fastpin"
    paths = sorted(package.rglob("*.py")) + sorted(package.rglob("*.pyi"))
    return {str(path.relative_to(package)): path.read_text("utf-8") for path in paths}


class Tree:
    """The package's files, parsed. `texts` are those of :func:`texts_of`."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self.sources = {file: _source(text) for file, text in texts.items()}
        self.trees = {file: source.tree for file, source in self.sources.items()}
        self._targets: dict[tuple[str, str], str | None] = {}

    @cached_property
    def imports(self) -> list[Import]:
        """All imports, those under TYPE_CHECKING and inside functions too.

        An import by a name whose end is not written down counts as an import of all files that it may name.
        """
        written = [
            Import(file, *one)
            for file, source in self.sources.items()
            if not file.endswith(".pyi")
            for one in source.imports
        ]
        files = [file for file in self.sources if file.endswith(".py") and not file.endswith("__init__.py")]
        modules = {file: f"fastpin.{file.removesuffix('.py').replace('/', '.')}" for file in files}
        return written + [
            Import(file, line, module, "", inside=False)
            for file, source in self.sources.items()
            for line, text, _ in source.named
            if text.startswith("fastpin")
            for other, module in modules.items()
            if other != file and module.startswith(text)
        ]

    def target(self, one: Import) -> str | None:
        """The file of the package that an import names; None for other packages, "" for the public face."""
        key = one.module, one.name
        if key not in self._targets:
            self._targets[key] = self._found_target(*key)
        return self._targets[key]

    def _found_target(self, module: str, name: str) -> str | None:
        first, *parts = module.split(".")
        if first != "fastpin":
            return None
        for candidate in ([*parts, name], parts):
            path = "/".join(part for part in candidate if part)
            for file in (f"{path}.py", f"{path}/__init__.py"):
                if file in self.trees:
                    return file if file != "__init__.py" else ""
        return ""

    def functions(self) -> Iterator[tuple[str, ast.FunctionDef]]:
        """Every function with its name, such as ``solver/run.py Run.follow``."""
        for file, source in self.sources.items():
            if not file.endswith(".pyi"):
                yield from ((f"{file} {name}", function) for name, function in source.functions)


def rank(file: str) -> int:
    """The rank of a file; the public face and ``python -m fastpin`` are above all."""
    folder, slash, _ = file.partition("/")
    if slash:
        return LEVELS.index(ABOVE_BODIES) if file in ABOVE_BODIES else RANKS[folder]
    return 0 if file.removesuffix(".py") in ROOT_FILES else max(RANKS.values()) + 1


def _folder(file: str) -> str:
    return file.partition("/")[0] if "/" in file else ""


def known_folders(tree: Tree) -> Iterator[str]:
    """Every folder has a rank, and every rank a folder."""
    folders = {file.partition("/")[0] for file in tree.trees if "/" in file}
    yield from (f"{folder}/ has no rank" for folder in sorted(folders - set(RANKS)))
    yield from (f"{folder}/ is missing" for folder in sorted(set(RANKS) - folders))
    yield from (f"{file} lies in a folder inside a folder" for file in tree.trees if file.count("/") > 1)


def one_direction(tree: Tree) -> Iterator[str]:
    """A file imports from its own folder and from lower ranks."""
    for one in tree.imports:
        target = tree.target(one)
        if target is None or one.file in ("__init__.py", "__main__.py") or _calls_a_face(tree, one):
            continue
        if target == "":
            yield f"{one.file}:{one.line} imports the public face"
        elif rank(target) > rank(one.file) or (_folder(target) != _folder(one.file) and rank(target) == rank(one.file)):
            yield f"{one.file}:{one.line} imports {target}, which is not of a lower rank"
        elif _folder(target) == "" and rank(target) >= rank(one.file) and rank(one.file) > 0:
            yield f"{one.file}:{one.line} imports {target}"


def _calls_a_face(tree: Tree, one: Import) -> bool:
    """Whether an excepted file imports the public face of fastpin, or of a folder, inside a function."""
    face = one.module == "fastpin" or (tree.target(one) or "").endswith("/__init__.py")
    return one.inside and one.file in UPWARD and face


def wings_apart(tree: Tree) -> Iterator[str]:
    """The core imports no file of a wing. It may import the public face of a wing."""
    for one in tree.imports:
        target = tree.target(one) or ""
        if _folder(one.file) in CORE and _folder(target) in WINGS and not target.endswith("/__init__.py"):
            yield f"{one.file}:{one.line} imports {target}, a file of a wing"


def no_circles(tree: Tree) -> Iterator[str]:
    """No file imports itself through others."""
    edges: dict[str, set[str]] = {}
    for one in tree.imports:
        target = tree.target(one)
        if target:
            edges.setdefault(one.file, set()).add(target)
    while ends := [file for file, targets in edges.items() if not targets & edges.keys()]:
        for file in ends:  # it leads to no circle
            del edges[file]

    def reached(file: str) -> set[str]:
        found, waiting = set(), [file]
        while waiting:
            for target in edges.get(waiting.pop(), ()):
                if target not in found:
                    found.add(target)
                    waiting.append(target)
        return found

    yield from (f"{file} imports itself through others" for file in sorted(edges) if file in reached(file))


def nothing_hidden(tree: Tree) -> Iterator[str]:
    """No import hides its file: behind the face of the own folder, behind dots, or behind a name in a text."""
    for one in tree.imports:
        if "/" in one.file and tree.target(one) == f"{_folder(one.file)}/__init__.py":
            yield f"{one.file}:{one.line} imports the face of its own folder"
        if one.module.startswith("."):
            yield f"{one.file}:{one.line} imports by a relative path"
    for file, source in tree.sources.items():
        for line, text, is_whole in source.named:
            if is_whole and text.startswith("fastpin"):
                yield f"{file}:{line} imports {text} by its name"


def _kernels(tree: Tree) -> dict[str, Source]:
    """The files of compiled functions: those of kernels/, and kernels of one folder above it."""
    return {file: source for file, source in tree.sources.items() if source.compiled or _folder(file) == "kernels"}


def kernels_alone(tree: Tree) -> Iterator[str]:
    """Kernels import kernels and their runtime only. They call those of other files only if no kernel calls them."""
    kernels = _kernels(tree)
    for one in tree.imports:
        target = tree.target(one)
        if one.file in kernels and target is not None and target not in kernels and _folder(target) != "runtime":
            yield f"{one.file}:{one.line} imports {one.module}"
    everywhere = {name for source in kernels.values() for name in source.compiled}
    inside = {called for source in kernels.values() for _, _, called in source.called}
    for file, source in kernels.items():
        for line, name, called in source.called:
            if name in inside and called in everywhere - set(source.compiled):
                yield f"{file}:{line} {name} calls {called} of another file"


def one_home(tree: Tree) -> Iterator[str]:
    """Some packages are imported in one place only, and ``print`` is called by the commands' ``say`` only."""
    named = [(file, line, text) for file, source in tree.sources.items() for line, text, _ in source.named]
    for file, line, module in [(one.file, one.line, one.module) for one in tree.imports] + named:
        homes = HOMES.get(module.split(".")[0])
        if homes is not None and _folder(file) not in homes:
            yield f"{file}:{line} imports {module}, whose home is {' and '.join(homes)}"
    for file, source in tree.sources.items():
        if file != PRINTS:
            yield from (f"{file}:{line} prints" for line in source.prints)


def units_with_thickness(tree: Tree) -> Iterator[str]:
    """Outputs do not ask for units per thickness."""
    for one in tree.imports:
        if one.name == "units_per_thickness" and one.file.split("/")[0] in OUTPUTS:
            yield f"{one.file}:{one.line} imports {one.name}; units of outputs come from units"


def nothing_private(tree: Tree) -> Iterator[str]:
    """No name with an underscore crosses a file."""
    for one in tree.imports:
        if tree.target(one) is not None and one.name.startswith("_") and not one.name.startswith("__"):
            yield f"{one.file}:{one.line} imports {one.name} of {one.module}"
    modules = {(one.file, one.name) for one in tree.imports if tree.target(one) and one.name and _is_module(tree, one)}
    for file, source in tree.sources.items():
        for line, owner, name in source.private:
            if (file, owner) in modules:
                yield f"{file}:{line} reaches for {owner}.{name}"


def _is_module(tree: Tree, one: Import) -> bool:
    path = "/".join([*one.module.split(".")[1:], one.name])
    return f"{path}.py" in tree.trees


def imports_at_the_top(tree: Tree) -> Iterator[str]:
    """Imports stand at the top of a file. Optional packages and the public face are the exceptions."""
    for one in tree.imports:
        if not one.inside or one.module.split(".")[0] in OPTIONAL:
            continue
        if one.file in LOCAL_IMPORTS or _calls_a_face(tree, one):
            continue
        yield f"{one.file}:{one.line} imports {one.module} inside a function"


def small(tree: Tree) -> Iterator[str]:
    """Files, functions and lists of parameters stay small."""
    for file, source in tree.sources.items():
        if source.lines > MOST_LINES:
            yield f"{file} has {source.lines} lines"
    kernels = _kernels(tree)
    for name, function in tree.functions():
        is_kernel = name.partition(" ")[0] in kernels
        if not is_kernel and _code_lines(function) > MOST_FUNCTION_LINES:
            yield f"{name} has {_code_lines(function)} lines"
        arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
        given = [argument.arg for argument in arguments if argument.arg not in ("self", "cls")]
        if name not in MANY_PARAMETERS and not is_kernel and len(given) > MOST_PARAMETERS:
            yield f"{name} has {len(given)} parameters"
    known = {name for name, _ in tree.functions()}
    yield from (f"{name} is excepted, but not there" for name in MANY_PARAMETERS if name not in known)


def _code_lines(function: ast.FunctionDef) -> int:
    """Lines of a function without its docstring."""
    first = function.body[0]
    lines = (function.end_lineno or 0) - function.lineno + 1
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
        lines -= (first.end_lineno or 0) - first.lineno + 1
    return lines


def exceptions_used(tree: Tree) -> Iterator[str]:
    """Every exception from a rule is still needed."""
    for file in (*UPWARD, *LOCAL_IMPORTS):
        if not any(one.file == file and one.inside for one in tree.imports):
            yield f"{file} is excepted, but imports nothing inside a function"


def sentences_in_folders(tree: Tree) -> Iterator[str]:
    """The docstring of each folder's ``__init__`` says in one line what the folder holds."""
    for folder in RANKS:
        text = ast.get_docstring(tree.trees.get(f"{folder}/__init__.py", ast.Module([], [])))
        if not text or not text.splitlines()[0].endswith("."):
            yield f"{folder}/__init__.py has no sentence"


RULES: tuple[Callable[[Tree], Iterator[str]], ...] = (
    known_folders,
    one_direction,
    wings_apart,
    no_circles,
    nothing_hidden,
    kernels_alone,
    one_home,
    units_with_thickness,
    nothing_private,
    imports_at_the_top,
    small,
    exceptions_used,
    sentences_in_folders,
)


def broken(texts: Mapping[str, str]) -> list[str]:
    """All sentences of all rules, for the files of the package by name."""
    tree = Tree(texts)
    return [f"{rule.__name__}: {sentence}" for rule in RULES for sentence in rule(tree)]
