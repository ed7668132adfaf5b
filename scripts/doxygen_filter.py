#!/usr/bin/env python3
"""doxygen_filter.py HEADER: prints the header as Doxygen reads it.

The INPUT_FILTER of Doxygen for the headers, whose comments are plain ones of //:
- A comment in front of a declaration documents it, and the declarations that follow
  without an empty line. One behind a declaration documents this one.
- The first comment of a header documents the file. In halfspace.h it is the main page.
- Indented lines of a comment are an example, which looks like code, or a table, which
  has columns, or follows an empty line. Other indented lines are a list of conditions.
- What is in `backticks` is shown as code. No character has another meaning.
Comments inside functions are left as they are, so Doxygen does not show them.
"""

import re
import sys
import textwrap

CODE = re.compile(r"[;{}]\s*(//.*)?$|^\s*#include", re.M)
SCOPE = re.compile(r'(typedef )?(class|struct|union|enum|namespace|extern "C")\b[^(]*$|'
                   r'extern "C"\s*$')


def escape(text):
    return re.sub(r'--|[\\@&$#<>%"]', r"\\\g<0>", text)


def prose(text):
    parts = text.split("`")
    if len(parts) % 2 == 0:  # one of them has no partner
        return escape(text)
    return "".join(f"<code>{escape(part)}</code>" if i % 2 else escape(part)
                   for i, part in enumerate(parts))


def items(text):
    """The text as a list: of hanging lines, or of what begins after a full stop."""
    begin = r"\n(?! )" if "\n " in text else r"(?<=[.:])\n(?=[A-Z])"
    found = (re.sub(r"\n *", "\n", item) for item in re.split(begin, text))
    return "<ul>\n" + "".join(f"<li>{prose(item)}</li>\n" for item in found) + "</ul>"


RENDER = {
    "prose": prose,
    "items": items,
    "table": lambda text: f"<pre>\n{prose(text)}\n</pre>",
    "code": lambda text: f"@code{{.cpp}}\n{text}\n@endcode",
}


def kind_of(text, is_apart):
    if not text.startswith(" "):
        return "prose"
    if is_apart and CODE.search(text):
        return "code"
    if is_apart or re.search(r"\S  +\S", text) or not text.endswith((".", ":")):
        return "table"
    return "items"


def documentation(comment):
    """The lines of a comment as Doxygen's."""
    paragraphs = [""]  # an empty one stands for an empty line
    in_list = False
    for line in comment:
        line = line.removeprefix(" ")
        in_list = line.startswith("- ") or (in_list and line.startswith("  "))
        indented = line.startswith("  ") and not in_list
        if line and paragraphs[-1] and paragraphs[-1].startswith("  ") == indented:
            paragraphs[-1] += "\n" + line
        else:
            paragraphs.append(line)
    blocks = []
    for before, text in zip(paragraphs, paragraphs[1:]):
        if not text:
            continue
        kind = kind_of(text, is_apart=not before)
        text = textwrap.dedent(text)
        if blocks and blocks[-1][0] == kind:
            blocks[-1][1] += "\n\n" + text
        else:
            blocks.append([kind, text])
    return "\n\n".join(RENDER[kind](text) for kind, text in blocks).split("\n") + [""]


def scope_of(head):
    """What a brace after this text contains: declarations, enumerators or a body."""
    head = re.sub(r"alignas\(\w+\)|\[\[\w+\]\]", "", head).strip()
    if head.startswith("template"):
        depth = 0
        for at, character in enumerate(head):
            depth += {"<": 1, ">": -1}.get(character, 0)
            if character == ">" and depth == 0:
                head = head[at + 1:].strip()
                break
    if not SCOPE.match(head):
        return "body"
    return "enum" if re.match(r"(typedef )?enum\b", head) else "declarations"


class Statements:
    """Knows, line after line, where statements begin, and in which scope."""

    def __init__(self):
        self.scopes, self.head, self.parentheses = [], "", 0

    def in_body(self):
        return "body" in self.scopes

    def at_begin(self):
        return not self.head.strip() and not self.in_body()

    def read(self, code):
        for at, character in enumerate(code + "\n"):
            self.head += character
            self.parentheses += {"(": 1, ")": -1}.get(character, 0)
            if character == "{":
                self.scopes.append("body" if self.in_body() or self.parentheses
                                   else scope_of(self.head[:-1]))
                if not self.in_body():
                    self.head = ""
            elif character == "}" and self.scopes:
                self.scopes.pop()
                if not self.in_body() and code[at + 1:].strip()[:1] not in (",", "{", ")"):
                    self.head = ""
            elif self.parentheses == 0 and not self.in_body() and (
                    character == ";" or
                    (character == "," and self.scopes[-1:] == ["enum"])):
                self.head = ""
        if re.fullmatch(r"\s*(public|protected|private):\s*", self.head):
            self.head = ""


def convert(source, is_main_page):
    out, comment, shared = [], [], []
    statements = Statements()
    is_first = True
    column = None  # of the comment behind the line before
    for line in source.split("\n"):
        stripped = line.strip()
        if stripped.startswith("//") and column == line.index("//"):
            out.append(f"{line[:column]}///< {prose(stripped[2:].strip())}")
            continue
        if stripped.startswith("//") and statements.at_begin():
            comment.append(stripped[2:])
            continue
        column = None
        if comment:
            shared = documentation(comment)
            if is_first:
                shared = ["@file", "", *shared]
                if is_main_page:
                    shared[:2] = ["@file", "Includes every public header.", "",
                                  "@mainpage halfspace", ""]
                out += [f"/// {text}".rstrip() for text in shared]
            comment, is_first = [], False
        if not stripped or stripped.startswith(("#", "static_assert")):
            shared = []
        elif (statements.at_begin() and not stripped.startswith(("}", "friend"))
              and not stripped.endswith(":")):
            out += [f"/// {text}".rstrip() for text in shared]
        code = line
        if not stripped.startswith(("#", "//")):
            if "  // " in line:
                code, _, behind = line.partition("  // ")
                if not statements.in_body() and not stripped.startswith("}"):
                    column = line.index("//")
                    line = f"{code}  ///< {prose(behind)}"
            depth = len(statements.scopes)
            statements.read(code)
            if len(statements.scopes) > depth and not statements.in_body():
                shared = []  # of what contains the declarations that follow
        out.append(line)
    return "\n".join(out)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as header:
        sys.stdout.write(convert(header.read(),
                                 sys.argv[1].endswith("/halfspace/halfspace.h")))
