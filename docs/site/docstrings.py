"""What griffe reads of the package, as the reference shows it: docstrings as they are written here, in Markdown."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import griffe

#: Lines of an example, from its first prompt to the end of its output.
_EXAMPLE = re.compile(r"^>>> .*(?:\n(?!\n).*)*", re.M)
#: A class, or one of its members, in the code of a sentence.
_NAME = re.compile(r"(?<!\[)`([A-Z]\w+)(?:\.(\w+))?(\([^`]*\))?`")
_PAGE = re.compile(r"Docs:\s+`docs/([\w-]+)\.md`")
#: The comments above an attribute that say what it is.
_MARK = "#: "

#: What verbs take for a shape, as a reader is told.
_SHAPED = "Shape | File"


class Docstrings(griffe.Extension):
    """Examples as code, names of classes as links, comments of attributes as docstrings, and verbs as the functions they are."""

    def on_package(self, *, pkg: griffe.Module, loader: Any, **kwargs: Any) -> None:
        """Everything is there by now."""
        _make_functions(pkg)
        public = {name for name in pkg.exports or () if isinstance(name, str) and name[0].isupper()}
        _visit(pkg, pkg, public)


def _make_functions(pkg: griffe.Module) -> None:
    """What `_verb(Shape.mesh)` decorates has the arguments of the method, after a shape, and says what that says."""
    module, shape = pkg["_verbs"], pkg["_shape.Shape"]
    for member in module.members.values():
        if member.is_alias or not member.is_function:
            continue
        for one in member.parameters:
            one.annotation = _SHAPED if str(one.annotation) == "_Shaped" else one.annotation
        made_of = [str(one.value) for one in member.decorators if str(one.value).startswith("_verb(")]
        if not made_of:
            continue
        method = shape.all_members[made_of[0].removesuffix(")").rpartition(".")[2]]
        method = method.final_target if method.is_alias else method
        first = griffe.Parameter("shape", annotation=_SHAPED, kind=griffe.ParameterKind.positional_only)
        member.parameters = griffe.Parameters(first, *list(method.parameters)[1:])
        member.returns = method.returns
        member.decorators = []
        if ">>>" not in member.docstring.value:
            member.docstring.value += f"\n\n{method.docstring.value}"


def _visit(thing: Any, pkg: griffe.Module, public: set[str]) -> None:
    for member in thing.members.values():
        # What is compiled has nothing to say but its types.
        if member.is_alias or member.name == "_chordal":
            continue
        if member.is_attribute and member.docstring is None:
            _read_comment(member)
        if member.docstring is not None:
            member.docstring.value = _in_markdown(member.docstring.value, pkg, public)
        if member.is_class:
            _hide_own_constructor(member)
        if member.is_class or member.is_module:
            _visit(member, pkg, public)


def _hide_own_constructor(made: griffe.Class) -> None:
    """A class that only the package itself makes, of what is compiled, shows no constructor."""
    constructor = made.members.get("__init__")
    if constructor is not None and any("_chordal." in str(one.annotation) for one in constructor.parameters):
        made.del_member("__init__")


def _read_comment(attribute: Any) -> None:
    """The lines that begin with `#:` above an attribute are its docstring."""
    if attribute.lineno is None or not isinstance(attribute.filepath, Path):
        return
    above = attribute.filepath.read_text(encoding="utf-8").split("\n")[: attribute.lineno - 1]
    found: list[str] = []
    while above and above[-1].strip().startswith(_MARK):
        found.insert(0, above.pop().strip().removeprefix(_MARK))
    if found:
        attribute.docstring = griffe.Docstring(" ".join(found), parent=attribute)


def _in_markdown(text: str, pkg: griffe.Module, public: set[str]) -> str:
    """A docstring as Markdown: examples in fences, links to what the package holds."""
    parts, end = [], 0
    for example in _EXAMPLE.finditer(text):
        parts += [_linked(text[end : example.start()], pkg, public), f"```pycon\n{example[0]}\n```\n"]
        end = example.end()
    return "".join([*parts, _linked(text[end:], pkg, public)])


def _linked(text: str, pkg: griffe.Module, public: set[str]) -> str:
    def link(name: re.Match[str]) -> str:
        owner, member = name[1], name[2]
        if owner not in public:
            return name[0]
        place = f"chordal.{owner}"
        if member is not None:
            if member not in pkg[owner].all_members:
                return name[0]
            place += f".{member}"
        return f"[{name[0]}][{place}]"

    return _PAGE.sub(lambda page: f"More: [{page[1]}](../{page[1]}.md).", _NAME.sub(link, text)).replace(".).", ".)")
