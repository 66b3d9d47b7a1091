"""Markdown pages as HTML."""

import pytest

from app.guide.rendering import anchor_of, headings_of, render_page, title_of

SERVED = {"docs/api.md": "api", "SECURITY.md": "security", "docs/arm.svg": "arm.svg"}


def body(text):
    return render_page(text, "docs/page.md", SERVED).body


@pytest.mark.parametrize(
    ("words", "anchor"),
    [
        ("Errors", "errors"),
        ("Keys, rate limits, other origins", "keys-rate-limits-other-origins"),
        ("3. Forward kinematics", "3-forward-kinematics"),
        ("`fk`, and q2", "fk-and-q2"),
        ("From a - b", "from-a---b"),
        ("θ and α_i", "θ-and-α_i"),
    ],
)
def test_anchors_are_those_of_forges(words, anchor):
    assert anchor_of(words.replace("`", "")) == anchor
    page = render_page(f"## {words}\n", "docs/page.md", {})
    assert page.headings[0].anchor == anchor
    assert f'<h2 id="{anchor}">' in page.body
    assert f'href="#{anchor}"' in page.body


def test_a_heading_that_stands_twice_has_two_anchors():
    found = headings_of("# A\n\n## Links\n\n## Links\n\n## Links\n")
    assert [one.anchor for one in found] == ["a", "links", "links-1", "links-2"]
    assert title_of(found) == "A"


@pytest.mark.parametrize(
    ("link", "address"),
    [
        ("api.md", "api"),
        ("api.md#errors", "api#errors"),
        ("../SECURITY.md", "security"),
        ("../docs/api.md", "api"),
        ("#here", "#here"),
        ("http://localhost:8000/docs", "http://localhost:8000/docs"),
    ],
)
def test_links_lead_to_what_is_served(link, address):
    assert f'<a href="{address}">this</a>' in body(f"See [this]({link}).")


def test_a_link_to_a_file_that_is_not_served_becomes_text():
    assert "<p>See <code>this</code> and that.</p>" in body(
        "See [`this`](../deploy/x.conf) and [that](y.md)."
    )


def test_pictures():
    assert '<img src="arm.svg" alt="An arm" />' in body("![An arm](arm.svg)")
    with pytest.raises(ValueError, match=r"other\.png"):
        body("![Another](other.png)")


def test_markup_in_a_page_is_shown_and_not_obeyed():
    assert "<script>" not in body(
        "<script>alert(1)</script>\n\n`<b>` and <b>\n\n```text\n<i>\n```\n"
    )


def test_commands_and_their_output_are_told_apart():
    page = body("```bash\ncurl\n```\n\n```text\nanswer\n```\n")
    assert '<pre class="code"><code>curl\n</code></pre>' in page
    assert '<pre class="output"><code>answer\n</code></pre>' in page
