"""The pages in Chromium without a screen or a network: the crater is drawn, turned, cut and coloured; a table is sorted."""

import io
import json
import time

import chromium
import numpy as np
import pytest
from chromium import browser
from PIL import Image
from rings import small_rings

from pockmark import run_scene
from pockmark.cli.report import report
from pockmark.view.page import CampaignReport, Cell, campaign_page

webdriver = pytest.importorskip("selenium.webdriver")
pytest.importorskip("trame_vtk")
pytest.importorskip("jinja2")
__all__ = ["browser"]  # a fixture
pytestmark = chromium.NEEDED
PATIENCE = 60  # s: two cores draw what a graphics card should


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page") / "run"
    run_scene(small_rings("4 ns"), folder, threads=1, progress=False)
    report([folder])
    return folder / "report.html"


def until(condition):
    """Wait until a condition holds; fail if it does not."""
    start = time.monotonic()
    while not condition():
        assert time.monotonic() - start < PATIENCE
        time.sleep(0.1)


def shot(frame):
    """Return what a frame shows, (height, width, 3), without its border."""
    image = Image.open(io.BytesIO(frame.screenshot_as_png)).convert("RGB")
    return np.asarray(image, dtype=int)[5:-5, 5:-5]


def moved(one, other):
    """Return the share of the pixels that differ."""
    return (np.abs(one - other).max(axis=2) > 30).mean()


def choose(browser, name, value):
    browser.execute_script(
        "const list = document.getElementById(arguments[0]); list.value = arguments[1];"
        "list.dispatchEvent(new Event('change'))",
        name,
        value,
    )


def loaded(browser):
    """Return the addresses that have been asked for since this was last called."""
    messages = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    return [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]


def test_the_crater_is_drawn_turned_cut_and_coloured(browser, page):
    browser.get(page.as_uri())
    frame = browser.find_element("id", "crater")
    browser.execute_script("arguments[0].scrollIntoView()", frame)
    until(lambda: frame.get_attribute("data-ready"))
    first = shot(frame)
    assert 0.05 < (first.min(axis=2) < 250).mean() < 0.9, "it is a body on a white ground"
    browser.switch_to.frame(frame)
    canvas = browser.find_element("tag name", "canvas")
    drag = webdriver.ActionChains(browser, duration=100).move_to_element(canvas).click_and_hold()
    drag.move_by_offset(90, 40).pause(0.2).move_by_offset(40, 20).pause(0.2).release().perform()
    browser.switch_to.default_content()
    until(lambda: moved(first, shot(frame)) > 0.03)
    turned = shot(frame)
    choose(browser, "cut", "cut across y")
    until(lambda: moved(turned, shot(frame)) > 0.03)
    cut = shot(frame)
    choose(browser, "colour", "plastic strain")
    until(lambda: moved(cut, shot(frame)) > 0.03)
    bars = browser.find_elements("css selector", "[data-bar]")
    assert [bar.get_attribute("data-bar") for bar in bars if bar.is_displayed()] == ["plastic strain"]
    print(f"turned {moved(first, turned):.0%}, cut {moved(turned, cut):.0%} of the pixels")
    said = [entry for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    assert not said
    assert not [address for address in loaded(browser) if not address.startswith(("file:", "data:", "blob:"))]


def test_a_table_is_sorted_by_a_click(browser, tmp_path):
    rows = [[Cell("b"), Cell("10", 10.0)], [Cell("a"), Cell("9", 9.0)], [Cell("c"), Cell("-")]]
    table = CampaignReport("t", "results.csv", ["name", "value"], rows, [], [], [], "")
    (tmp_path / "page.html").write_text(campaign_page(table, "now"), encoding="utf-8")
    browser.get((tmp_path / "page.html").as_uri())

    def names():
        return [
            row.find_element("css selector", "td").text
            for row in browser.find_elements("css selector", "tbody tr")
        ]

    by_name, by_value = browser.find_elements("css selector", "th button")
    by_value.click()
    assert names() == ["a", "b", "c"]  # 9 before 10, and no number last
    by_value.click()
    assert names() == ["b", "a", "c"]
    by_name.click()
    assert names() == ["a", "b", "c"]
