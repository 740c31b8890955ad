"""A person walks the desk in a real browser: open, filter, edit, rerun, undo, play, keys alone, 1,000 cases, a phone.

No console error anywhere; contrast after WCAG's formula; every focused thing shows that it is.
"""

import json
import re
import shutil
import threading
import time
from contextlib import contextmanager

import pytest

from flows.desk.app import application
from flows.desk.command import server_of, socket_at
from tests.flows.desk.browser import walking
from tests.flows.desk.conftest import foreign

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to look with")]
CASE = "left-turn-at-signal"


@contextmanager
def serving(folder):
    with socket_at("127.0.0.1", 0) as listening:
        server = server_of(application(folder))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
        server.should_exit = True
        thread.join(20)


@pytest.fixture(scope="module")
def tab():
    with walking(CHROMIUM) as walker:
        yield walker


@pytest.fixture
def walker(tab):
    """The tab; whatever a test did, nothing may have gone wrong in the page."""
    tab.faults.clear()
    tab.size(1440, 900)
    tab.theme("light")
    yield tab
    tab.run("1")
    assert tab.faults == []


@pytest.fixture
def desk(runs, walker):
    with serving(runs) as address:
        yield address
        walker.open("about:blank")  # a page that is left open would ask a server that is gone


@pytest.fixture
def case(desk, config):
    return f"{desk}/case/{config.name}/{CASE}"


def mended(walker, number):
    """Wait until so many changes have been made and are shown."""
    walker.until(f"document.documentElement.dataset.mended === '{number}'")


def until(frame, script):
    deadline = time.monotonic() + 20
    while not frame(script):
        assert time.monotonic() < deadline, script
        time.sleep(0.05)


def value(field):
    return f"document.querySelector('[data-field=\"{field}\"].value').textContent"


def test_open_filter_sort_and_go_to_a_case(walker, desk):
    walker.open(f"{desk}/")
    walker.until("document.querySelectorAll('.cases tbody tr').length === 3")
    walker.run("[...document.querySelectorAll('.facets a')].find(a => a.textContent.includes('rear-end')).id = 'rear'")
    walker.click("#rear")
    walker.until("document.querySelectorAll('.cases tbody tr').length === 1")
    walker.click(".clear")
    walker.until("document.querySelectorAll('.cases tbody tr').length === 3")
    walker.key("/")
    walker.type("left turn signal")
    walker.key("Enter")
    walker.until("document.querySelectorAll('.cases tbody tr').length === 1")
    walker.click(".who a")
    walker.until(f"document.title.startsWith('{CASE}')")
    assert "1 of 1" in walker.text()
    walker.key("l")
    walker.until("document.querySelector('#text')?.value === 'left turn signal'")


def test_edit_rerun_and_undo_with_the_mouse(walker, case, config):
    walker.open(case)
    walker.click('[data-field="roads.N.lanes_forward"].value')
    walker.until("document.activeElement.id === 'edit-value'")
    walker.type("2")
    walker.run("document.querySelector('#edit-why').value = 'the drawing shows two'")
    walker.click(".editor .primary")
    mended(walker, 1)
    assert walker.run(value("roads.N.lanes_forward")) == "2"
    assert "the drawing shows two" in walker.text()
    assert json.loads((config / CASE / "result.json").read_text())["status"] == "generated"
    walker.click("#rerun")
    mended(walker, 2)
    assert walker.run(value("roads.N.lanes_forward")) == "2"
    walker.click("#undo")
    mended(walker, 3)
    assert walker.run(value("roads.N.lanes_forward")) == "3"
    assert walker.run("document.querySelector('#undo').disabled")


def test_a_refused_edit_says_why_at_its_field_and_the_case_stays(walker, case):
    walker.open(case)
    walker.click('[data-field="vehicles.V2.start_lane"].value')
    walker.until("document.activeElement.id === 'edit-value'")
    walker.type("99")
    walker.click(".editor .primary")
    walker.until("document.querySelector('.editor .say').textContent.includes('99 is not possible')")
    walker.faults[:] = [f for f in walker.faults if "422" not in f]  # the browser logs every refusal by its number
    walker.key("Escape")
    assert walker.run("document.querySelector('.editor') === null")
    assert walker.run("document.activeElement.dataset.field") == "vehicles.V2.start_lane"


def test_a_vehicle_is_dragged_to_another_lane(walker, case):
    walker.open(case)
    walker.until("document.querySelector('.car[data-actor=V2]')")
    lane = '.strip.lane[data-road="N"][data-direction="forward"][data-lane="2"]'
    walker.run(f"document.querySelector('{lane}').id = 'target'")
    # a point of the lane on the screen, since a lane's own middle may be off the map
    walker.run(
        "(() => { const car = document.querySelector('.car[data-actor=V2]');"
        " const own = [...document.querySelectorAll('.strip.lane')]"
        ".find(s => s.dataset.road === 'N' && s.dataset.direction === 'forward' && s.dataset.lane === '1');"
        " const first = s => s.getAttribute('points').split(' ')[0].split(',').map(Number);"
        " const a = first(own), b = first(target);"
        " const mark = document.createElementNS('http://www.w3.org/2000/svg', 'circle'); mark.id = 'there';"
        " mark.setAttribute('r', 0.3); mark.setAttribute('cx', Number(car.dataset.x) + b[0] - a[0]);"
        " mark.setAttribute('cy', Number(car.dataset.y) + 8);"
        " mark.style.pointerEvents = 'none'; document.querySelector('#map').append(mark); })()"
    )
    walker.drag(".car[data-actor=V2] rect", "#there")
    mended(walker, 1)
    assert walker.run(value("vehicles.V2.start_lane")) == "2"
    assert "moved on the map" in walker.text()


def test_a_road_is_chosen_by_picking_it_on_the_map(walker, case):
    walker.open(case)
    walker.click('[data-field="vehicles.V1.exit_road"].value')
    walker.until("document.activeElement.id === 'edit-value'")
    walker.click('.name[data-road="S"]')
    assert walker.run("document.querySelector('#edit-value').value") == "S"


def test_facts_sentences_and_the_map_light_up_together(walker, case):
    walker.open(case)
    walker.click("[data-sentence]:nth-of-type(1)")
    assert walker.run("document.querySelectorAll('.told.lit').length") == 1
    walker.key("Escape")
    walker.click('.name[data-road="N"]')
    assert walker.run("document.querySelectorAll('.strip.lit[data-road=N]').length") > 2
    assert walker.run("document.querySelector('.told.lit').textContent").startswith("The north/south roadway")
    walker.key("Escape")
    walker.click(".car[data-actor=V1]")
    assert walker.run("[...document.querySelectorAll('.told.lit')].some(n => n.textContent.includes('Honda'))")
    assert walker.run("document.querySelector('details[data-group=V1] summary').classList.contains('lit')")
    walker.key("Escape")
    assert walker.run("document.querySelectorAll('.lit').length") == 0


def test_the_player_plays_and_shares_what_is_pointed_at(walker, case):
    walker.open(case)
    frame = walker.inside()
    until(frame, "document.readyState === 'complete'")
    assert "0.00 /" in frame("document.querySelector('#clock').textContent")
    frame("document.querySelector('#play').click()")
    until(frame, "Number(document.querySelector('#time').value) > 10")
    assert frame("getComputedStyle(document.querySelector('aside')).display") == "none"
    walker.click(".car[data-actor=V1]")
    until(frame, "document.querySelector('#because').textContent.includes('Honda')")
    frame("document.querySelectorAll('#legend span')[1].focus()")
    walker.until("document.querySelector('.car[data-actor=V2]').classList.contains('lit')")


def test_a_page_that_scrolls_under_a_resting_pointer_puts_nothing_out(walker, case):
    walker.open(case)
    frame = walker.inside()
    until(frame, "document.readyState === 'complete'")
    walker.click(".car[data-actor=V1]")
    frame("parent.postMessage({ sgcad: 'pointed', things: ['V2'] }, '*')")
    walker.until("document.querySelector('.car[data-actor=V2]').classList.contains('lit')")
    walker.run("window.scrollBy(0, 300)")
    walker.run("new Promise(done => setTimeout(done, 400))")  # Chromium tells of the new place within 100 ms
    assert walker.run("document.querySelector('.car[data-actor=V2]').classList.contains('lit')")
    walker.mouse("mouseMoved", 5, 5)
    walker.mouse("mouseMoved", *walker.place(".car[data-actor=V1]"))
    walker.until("document.querySelector('.car[data-actor=V1]').classList.contains('lit')")


def test_keys_alone_are_enough(walker, desk):
    walker.open(f"{desk}/")
    walker.until("document.querySelectorAll('.cases tbody tr').length === 3")
    walker.key("j")
    walker.key("j")
    walker.key("Enter")
    walker.until("document.querySelector('main.case')")
    walker.tab_to("e.dataset.field === 'conditions.surface'", 400)
    walker.key("Enter")
    walker.until("document.activeElement.id === 'edit-value'")
    walker.run("document.activeElement.value = 'wet'")  # choosing in a select's own list is the browser's
    walker.key("Tab")
    walker.key("Enter")
    mended(walker, 1)
    assert walker.run(value("conditions.surface")) == "wet"
    assert walker.run("document.activeElement.dataset.field") == "conditions.surface"
    walker.key("u")
    mended(walker, 2)
    assert walker.run("document.querySelector('#undo').disabled")
    walker.run("document.activeElement.blur()")
    walker.key("n")
    walker.until("document.querySelector('.steps a[rel=prev]')")


def test_what_has_the_focus_shows_it(walker, desk, case):
    for page in (f"{desk}/", case):
        walker.open(page)
        for _ in range(40):
            walker.key("Tab")
            shown = walker.run(
                "(e => { if (!e || e === document.body || e.tagName === 'IFRAME') return true;"
                " const s = getComputedStyle(e);"
                " const inner = e.closest('#map') && e.querySelector('circle, path, rect');"
                " return (s.outlineStyle !== 'none' && parseFloat(s.outlineWidth) >= 2)"
                " || (inner && getComputedStyle(inner).stroke === 'rgb(26, 134, 184)'); })(document.activeElement)"
            )
            assert shown, walker.run("document.activeElement.outerHTML.slice(0, 200)")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_everything_written_can_be_read(walker, desk, case, runs, theme):
    """Contrast of at least 4.5 (3 for large letters), WCAG 2.1, 1.4.3."""
    walker.theme(theme)
    for name, status in (("a", "refused"), ("b", "failed"), ("c", "exhausted")):
        foreign(runs / "kit", name, status=status, reason="for a reason")
    for page in (f"{desk}/", f"{desk}/?status=failed", case, f"{desk}/case/kit/a", f"{desk}/nowhere"):
        walker.open(page)
        walker.run("document.querySelectorAll('details').forEach(d => { d.open = true; })")
        assert walker.poor() == [], page
        assert walker.run("getComputedStyle(document.documentElement).colorScheme") == theme
        walker.faults[:] = [f for f in walker.faults if "404" not in f]


def test_no_name_is_missing_for_those_who_listen(walker, desk, case):
    for page in (f"{desk}/", case):
        walker.open(page)
        walker.call("Accessibility.enable")
        nodes = walker.call("Accessibility.getFullAXTree")["nodes"]
        roles = ("button", "link", "textbox", "searchbox", "combobox", "checkbox", "Iframe", "image")
        unnamed = [n for n in nodes if not n.get("ignored") and n.get("role", {}).get("value") in roles
                   and not n.get("name", {}).get("value")]  # fmt: skip
        assert unnamed == []
        assert walker.run("document.documentElement.lang") == "en"
        assert walker.run("document.querySelectorAll('h1').length") == 1


@pytest.mark.parametrize("size", [(390, 800), (768, 1024), (1440, 900)])
def test_every_screen_is_wide_enough(walker, desk, case, size):
    walker.size(*size, mobile=size[0] < 500)
    for page in (f"{desk}/", case):
        walker.open(page)
        assert walker.run("document.documentElement.scrollWidth") <= size[0], page
    assert walker.run("document.querySelector('#map').getBoundingClientRect().width") > 240


def test_a_thousand_cases_are_there_at_once_and_turn_by_pages(walker, tmp_path):
    facts = [
        {"field": f"roads.N.x{k}", "value": k, "basis": "text", "status": "stated", "confidence": 0.5}
        for k in range(60)
    ]
    for k in range(1000):
        foreign(tmp_path / "kit", f"case-{k:04d}", facts=facts)
    with serving(tmp_path) as address:
        walker.open(f"{address}/")
        walker.until("document.querySelector('h1').textContent.includes('1000 cases')")
        walker.open(f"{address}/?sort=case&page=2")
        assert walker.run("document.querySelectorAll('.cases tbody tr').length") == 100
        assert walker.run("document.querySelector('.who a').textContent") == "case-0100"
        walker.click("[rel=next]")
        walker.until("document.querySelector('.who a').textContent === 'case-0200'")
        walker.open("about:blank")


def test_a_case_that_changes_on_disk_is_told_of_on_the_open_page(walker, case, config):
    walker.open(case)
    file = config / CASE / "result.json"
    file.write_text(file.read_text() + " ")
    walker.until("!document.querySelector('#changed').hidden", 15)
    walker.click("#reload")
    walker.until("document.querySelector('#changed').hidden")
    shutil.rmtree(config / CASE)
    walker.until("document.querySelector('#changed').textContent.includes('removed from the folder')", 15)
    # what the page still asks of the removed case, its player's frame among it, is refused
    walker.faults[:] = [f for f in walker.faults if "404" not in f and "frame-ancestors" not in f]


def test_html_in_a_report_is_text(walker, case, config):
    evil = "<img src=x onerror=\"document.title='owned'\"><script>document.title='owned'</script>"
    result = json.loads((config / CASE / "result.json").read_text())
    result["notes"] = [{"kind": "finding", "field": "", "subject": "", "text": evil}]
    (config / CASE / "result.json").write_text(json.dumps(result))
    (config / CASE / "report.txt").write_text(evil + (config / CASE / "report.txt").read_text())
    walker.open(case)
    assert walker.run("document.title").startswith(CASE)
    assert walker.run("document.querySelectorAll('img[src=x]').length") == 0
    assert re.search(r"<img src=x", walker.run("document.querySelector('#narrative').textContent"))
