"""Modules of the package do not import each other in a circle, not even within functions. Imports for type checkers are exempt."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from conftest import ROOT

import chordal
from chordal import _registry

PACKAGE = ROOT / "python" / "chordal"


def module_of(path: str) -> str:
    """The module of a file, given relative to the folder above its package."""
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """The imports that run at some time."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        yield node
    is_for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    for child in node.orelse if is_for_types and isinstance(node, ast.If) else ast.iter_child_nodes(node):
        yield from statements(child)


def imported(name: str, path: str, text: str, names: set[str]) -> Iterator[str]:
    """The modules, among those with these names, that a module imports. That the package above them is imported does not count."""
    for statement in statements(ast.parse(text)):
        if isinstance(statement, ast.Import):
            yield from (alias.name for alias in statement.names)
            continue
        package = (name if path.endswith("/__init__.py") else name.rpartition(".")[0]).split(".")
        above = package[: len(package) + 1 - statement.level] if statement.level else []
        base = ".".join([*above, *([statement.module] if statement.module else [])])
        for alias in statement.names:
            yield f"{base}.{alias.name}" if f"{base}.{alias.name}" in names or alias.name == "_chordal" else base


def uses(texts: Mapping[str, str]) -> dict[str, set[str]]:
    """The modules that each module imports, among those given by their paths."""
    names = {module_of(path) for path in texts}
    return {module_of(path): set(imported(module_of(path), path, text, names)) & names - {module_of(path)} for path, text in texts.items()}


def circles(texts: Mapping[str, str]) -> list[str]:
    """The circles among modules, each by its members."""
    graph = uses(texts)

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        todo = [start]
        while todo:
            for following in graph[todo.pop()] - seen:
                seen.add(following)
                todo.append(following)
        return seen

    below = {name: reached(name) for name in graph}
    rings = [[other for other in found if name in below[other]] for name, found in below.items() if name in found]
    return sorted({", ".join(sorted(ring)) for ring in rings})


def test_modules_import_each_other_one_way() -> None:
    texts = {path.relative_to(PACKAGE.parent).as_posix(): path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert len(texts) > 50
    assert circles(texts) == []


def test_circles_are_found_within_functions_and_not_in_imports_for_types() -> None:
    def of(text: str) -> list[str]:
        return circles({"p/__init__.py": "from p._a import A", "p/_a.py": "from p._b import B", "p/_b.py": text, "p/_c.py": ""})

    assert of("def f():\n    from p._a import A") == ["p._a, p._b"]
    assert of("def f():\n    from p import _a") == ["p._a, p._b"]
    assert of("import p._a") == ["p._a, p._b"]
    assert of("from . import _a") == ["p._a, p._b"]
    assert of("from p import _c\ndef f():\n    import p\n    return p.A") == ["p, p._a, p._b"]
    assert of("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from p._a import A") == []
    assert of("if TYPE_CHECKING:\n    pass\nelse:\n    from ._a import A") == ["p._a, p._b"]


def test_everything_is_entered_in_the_registry() -> None:
    entries = _registry.Registry.__annotations__
    assert vars(_registry.registered).keys() == entries.keys()
    assert _registry.registered.mesh is chordal.Mesh
