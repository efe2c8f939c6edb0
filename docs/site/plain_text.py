"""Comments and docstrings, which are plain text, as Markdown; and signatures as HTML."""

from __future__ import annotations

import html
import re
from typing import Callable

from commands import title_of_doc
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexer import Lexer

FORMATTER = HtmlFormatter(nowrap=True)
ITEM = re.compile(r"(- |\d+\. )(.*)")
Link = Callable[[str], "str | None"]  # the address of what a word names


def escape(text: str) -> str:
    """Text that Markdown leaves as it is."""
    return re.sub(r"[\\`*_{}\[\]<>$~^|#&]", lambda found: f"&#{ord(found.group())};", text)


def code(text: str) -> str:
    return f"<code>{escape(text)}</code>" if re.search(r"[`|]", text) else f"`{text}`"


def prose(text: str, link: Link) -> str:
    """Running text, whose names of code are shown as such, with links to what they name."""

    def linked(name: str) -> str:
        address = link(name)
        page = re.match(r"docs/([a-z-]+)\.md", name)
        return f"[{title_of_doc(page[1]) if page else code(name)}]({address})" if address else code(name)

    out = []
    for part in re.split(r"(`[^`]+`)", re.sub(r"\s+", " ", text).replace("``", "`")):
        if part.startswith("`") and len(part) > 1:
            out.append(linked(part[1:-1]))
            continue
        at = 0
        # Files, what is called, qualified names, and names that are no words: camel case and with underscores.
        for name in re.finditer(r"(?<![\w/.\"])(?:[\w/-]+\.(?:md|hpp)(?:#[\w-]+)?|(?:\w+::)*\w+\(\)|(?:\w+::)+\w+"
                                r"|[A-Z][a-z]+(?:[A-Z][a-z]*)+|[a-z]{2,}(?:_[a-z]+)*_[a-z]{2,})(?![\w/])", part):
            address = link(name.group())
            if address or "(" in name.group() or "_" in name.group() or "::" in name.group():
                out += [escape(part[at:name.start()]), linked(name.group())]
                at = name.end()
        out.append(escape(part[at:]))
    words = "".join(out).strip()
    # What would begin a list or a quotation.
    return re.sub(r"^([-+]|\d+(?=\.))", lambda begin: f"&#{ord(begin.group()[0])};" + begin.group()[1:], words)


def block(lines: list[str]) -> str:
    """Lines that stay as they are: formulas, tables, code."""
    least = min(len(line) - len(line.lstrip()) for line in lines if line)
    text = "\n".join(line[least:] for line in lines).strip("\n")
    language = "pycon" if text.startswith(">>> ") else "cpp" if re.search(r"[;{]$", text, re.M) else "text"
    return f"```{language}\n{text}\n```"


def signature(text: str, lexer: Lexer, address: Callable[[str], str | None]) -> str:
    """Highlighted, with links from the names that have an address."""

    def linked(name: re.Match[str]) -> str:
        to = address(html.unescape(name.group()))
        return f'<a href="{to}">{name.group()}</a>' if to else name.group()

    shown = re.sub(r'<span class="[wp]">([^<]*)</span>', r"\1", highlight(text, lexer, FORMATTER).rstrip("\n"))
    return re.sub(r'(?<=<span class="n">)\w+(?=</span>)', linked, shown)


def signatures(shown: list[str]) -> str:
    """A block of them."""
    return '<div class="highlight"><pre><code>' + "\n".join(shown) + "</code></pre></div>"


def indented(text: str, by: int = 4) -> str:
    return "\n".join(" " * by + line if line else line for line in text.split("\n")).lstrip(" ")


def markdown(text: str, link: Link) -> str:
    """Paragraphs, lists with "-" or numbers, and lines that stay as they are: indented by two or more, or of a session
    of Python."""
    parts: list[str] = []
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        begin = at
        indent = len(lines[at]) - len(lines[at].lstrip())
        listed = ITEM.match(lines[at].strip()) and (indent >= 2 or at == 0 or not lines[at - 1])
        if not lines[at].strip():
            at += 1
        elif listed:
            items: list[list[str]] = []
            while at < len(lines) and lines[at].strip():
                here = len(lines[at]) - len(lines[at].lstrip())
                item = ITEM.match(lines[at].strip())
                if here == indent and item:
                    items.append([item.group(2)])
                elif here > indent:
                    items[-1].append(lines[at].strip())
                else:
                    break
                at += 1
            parts.append("\n".join(f"- {prose(' '.join(item), link)}" for item in items))
        elif lines[at].startswith(">>> "):
            while at < len(lines) and lines[at].strip():
                at += 1
            parts.append(block(lines[begin:at]))
        elif indent >= 2 or re.search(r"\S {3,}\S", lines[at]):
            while at < len(lines) and (not lines[at].strip() or lines[at].startswith("  ")
                                       or re.search(r"\S {3,}\S", lines[at])):
                at += 1
            parts.append(block(lines[begin:at]))
        else:
            while at < len(lines) and lines[at].strip() and not lines[at].startswith("  "):
                at += 1
            parts.append(prose(" ".join(lines[begin:at]), link))
    return "\n\n".join(parts)
