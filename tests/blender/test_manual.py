"""The manual: its page of options is that of the operators, its links and pictures are there."""

import importlib.util
import re

import pytest
from conftest import ROOT

DOCS = ROOT / "docs"


def test_page_of_options_is_up_to_date():
    spec = importlib.util.spec_from_file_location("options", DOCS / "options.py")
    options = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(options)
    assert options.PAGE.read_text(encoding="utf-8") == options.page(), "run: uv run docs/options.py"


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")) + [ROOT / "README.md"], ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    links = [link.split("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text)]
    missing = [link for link in links if link and "://" not in link and not (page.parent / link).exists()]
    assert not missing
