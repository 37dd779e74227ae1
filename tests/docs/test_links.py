"""Every relative link on every page leads to a file and, if it names one, to a heading."""

from __future__ import annotations

import pytest

from pages import LINKED, Link, fault_of, links_of, slug, text_of


@pytest.mark.parametrize("page", LINKED)
def test_links_lead_somewhere(page: str) -> None:
    faults = [fault for link in links_of(text_of(page)) if (fault := fault_of(page, link))]
    assert not faults, "\n".join(faults)


def test_many_links_are_followed() -> None:
    assert sum(1 for page in LINKED for link in links_of(text_of(page)) if not link.target.startswith("http")) > 300


def test_a_missing_file_and_a_missing_heading_are_found() -> None:
    assert "no file" in str(fault_of("README.md", Link(1, "docs/nowhere.md")))
    assert "no heading" in str(fault_of("README.md", Link(1, "docs/models.md#nowhere")))
    assert "no heading" in str(fault_of("docs/models.md", Link(1, "#nowhere")))
    assert fault_of("README.md", Link(1, "docs/models.md#error-bars")) is None


def test_links_in_code_are_no_links() -> None:
    assert [link.target for link in links_of("[a](b) `[c](d)`\n```\n[e](f)\n```\n![g](h)\n")] == ["b", "h"]


def test_headings_have_the_anchors_of_github() -> None:
    assert slug("Keys and TLS for other users") == "keys-and-tls-for-other-users"
    assert slug("`--rest`: how, and why?") == "--rest-how-and-why"
