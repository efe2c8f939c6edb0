"""A hook of mkdocs: the menu of a page opens the page's own sections only, so that no page grows with all others.

Another section is a link to its first page.
"""

from __future__ import annotations

import copy
from typing import Any

from mkdocs.structure.nav import Link, Navigation, Section


def first_page(item: Any) -> Any:
    return first_page(item.children[0]) if item.children else item


def shortened(item: Any) -> Any:
    if not isinstance(item, Section):
        return item
    if not item.active:
        return Link(item.title, first_page(item).url)
    section = copy.copy(item)
    section.children = [shortened(inner) for inner in item.children]
    return section


def on_page_context(context: dict[str, Any], page: Any, config: Any, nav: Navigation) -> dict[str, Any]:
    menu = copy.copy(nav)
    menu.items = [shortened(item) for item in nav.items]
    return {**context, "nav": menu}
