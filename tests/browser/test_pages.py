"""The report in a real browser, as different readers meet them."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from browser.conftest import DESK, PHONE, SCREENSHOTS
from report.synthetic import PARAMETERS, write_run

from visuohaptic.report.page import make_report

pytestmark = pytest.mark.slow
EVIL = "cup/../../<script>alert(1)</script>"
NAMES = ("cup/mug", "ball/marble", EVIL, "ball/Kännchen 茶" + "x" * 250)
NARROWEST = {"width": 320, "height": 640}
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
# At night only colours differ from the day's, and on a phone only what has a size or scrolls.
READERS = {
    "light": ("light", DESK, RULES),
    "dark": ("dark", DESK, ["color-contrast"]),
    "phone": ("light", PHONE, ["target-size", "scrollable-region-focusable"]),
}
EVERY_READER = pytest.mark.parametrize(
    "reader", ["light", *(pytest.param(name, marks=pytest.mark.long) for name in ("dark", "phone"))]
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A report with everything on it, names that mean harm among them."""
    folder = tmp_path_factory.mktemp("pages")
    files = write_run(folder, NAMES, pipelines=("paper", "order_free"))
    make_report(files, folder / "report.html", PARAMETERS, [*NAMES, "cup/lost"])
    return folder


def faults(page, part=None, rules=RULES):
    """List what axe-core finds on a page or on a part of it, in a line each."""
    options = {"runOnly": rules, "resultTypes": ["violations"]}
    found = Axe().run(page, part, options=options).response["violations"]
    return [f"{fault['id']}: {fault['nodes'][0]['html'][:200]}" for fault in found]


def unfold(page):
    """Open everything that is folded."""
    page.locator("details").evaluate_all("all => all.forEach((each) => { each.open = true; })")


def sideways(page):
    return page.evaluate("document.documentElement.scrollWidth - innerWidth")


@EVERY_READER
def test_every_reader_finds_a_page_without_barriers(visit, keep, folder, reader):
    scheme, viewport, rules = READERS[reader]
    page = visit(folder / "report.html", scheme, viewport)
    keep(page, f"report_{reader}")
    assert sideways(page) <= 0
    unfold(page)
    assert sideways(page) <= 0
    assert faults(page, rules=rules) == []
    page.set_viewport_size(NARROWEST)
    assert sideways(page) <= 0


@pytest.fixture(scope="module")
def report(visit, folder):
    """The report by day on a desk, unfolded, and opened once for all tests below, which run in their order."""
    page = visit(folder / "report.html")
    unfold(page)
    return page


def test_the_filter_finds_objects_and_an_anchor_leads_past_it(report, keep):
    report.locator("#object-filter").fill("  CUP/m ")
    shown = report.locator("article.object:visible")
    assert shown.evaluate_all("all => all.map((one) => one.dataset.name)") == ["cup/mug"]
    assert report.locator("#object-count").inner_text() == f"1 of {len(NAMES)}"
    keep(report.locator(".filter"), "filter")
    hidden = report.locator('article.object[data-name="ball/marble"]')
    assert not hidden.is_visible()
    report.locator('#credits a:has-text("marble")').click()
    hidden.wait_for(state="visible")
    report.locator("#object-filter").fill("")
    assert shown.count() == len(NAMES)


def test_every_anchor_leads_to_its_place(report):
    count, lost = report.evaluate(
        """async () => {
          const lost = [];
          const links = [...document.querySelectorAll('a[href^="#"]')];
          for (const link of links) {
            link.click();
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
            const target = document.getElementById(decodeURIComponent(link.hash.slice(1)));
            const top = target?.getBoundingClientRect().top ?? Infinity;
            const last = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;
            if (location.hash !== link.hash || top < -2 || (top > 60 && !last)) lost.push([link.hash, top]);
          }
          return [links.length, lost];
        }"""
    )
    assert count > 2 * len(NAMES)
    assert lost == []


def test_the_methods_text_is_copied(report):
    report.context.grant_permissions(["clipboard-read", "clipboard-write"])
    report.locator("#copy-methods").click()
    report.get_by_text("Copied.").wait_for()
    copied = report.evaluate("navigator.clipboard.readText()")
    assert copied == report.locator("#methods-text").inner_text().strip()
    assert "The seed was 2018." in copied


@pytest.fixture(scope="module")
def model(report):
    """A model that is in sight."""
    figure = report.locator(".model").first
    figure.locator("canvas").wait_for()
    report.wait_for_timeout(300)
    return figure


def eye(model):
    """Return azimuth and elevation in degrees, and the zoom."""
    shown = model.locator("canvas").evaluate("one => ({ ...one.dataset })")
    return tuple(float(shown[name]) for name in ("azimuth", "elevation", "zoom"))


def colours(model):
    """Return how many pixels of the drawing are of the surface's left half, right half and of squares."""
    return model.locator("canvas").evaluate(
        """canvas => {
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const counts = { red: 0, blue: 0, yellow: 0 };
          for (let i = 0; i < data.length; i += 4) {
            const [red, green, blue, alpha] = data.slice(i, i + 4);
            if (alpha < 100) continue;
            if (red > 60 && red > 2 * green && red > 2 * blue) counts.red++;
            if (blue > 60 && blue > 2 * green && blue > 2 * red) counts.blue++;
            if (green > 80 && red > 80 && blue < green) counts.yellow++;
          }
          return counts;
        }"""
    )


def test_a_model_shows_its_surface_and_the_squares_without_webgl(report, model):
    stage = model.locator(".stage")
    assert stage.get_attribute("aria-label").startswith("Model of ball/")
    first = model.locator(".viewpoints").input_value()
    model.locator(".viewpoints").select_option("all")
    report.wait_for_timeout(300)
    counts = colours(model)
    model.locator(".viewpoints").select_option(first)
    # The ball is red where x is below 0, and blue elsewhere.
    assert min(counts["red"], counts["blue"]) > 10_000
    assert counts["yellow"] > 0
    assert not report.evaluate("'Plotly' in window")


def test_a_model_turns_by_its_buttons_and_by_the_keyboard(report, model, keep):
    stage, drawn = model.locator(".stage"), "one => one.toDataURL()"
    azimuth, elevation, zoom = eye(model)
    shown = model.locator("canvas").evaluate(drawn)
    model.get_by_label("Turn right").click()
    model.get_by_label("Turn up").press("Space")
    model.get_by_label("Come nearer").click()
    report.wait_for_timeout(300)
    assert eye(model) == pytest.approx((azimuth + 15, elevation + 15, 1.25 * zoom))
    assert model.locator("canvas").evaluate(drawn) != shown
    stage.focus()
    for key in ("ArrowLeft", "ArrowDown", "-"):
        report.keyboard.press(key)
    report.wait_for_timeout(300)
    assert eye(model) == pytest.approx((azimuth, elevation, zoom))
    assert model.locator("canvas").evaluate(drawn) == shown
    for _ in range(12):
        report.keyboard.press("ArrowUp")
    report.wait_for_timeout(300)
    assert eye(model)[1] == 90
    report.keyboard.press("Home")
    report.wait_for_timeout(300)
    assert eye(model) == pytest.approx((azimuth, elevation, zoom))
    keep(model, "model")
    assert faults(report, ".model") == []


def test_half_a_turn_shows_the_other_side(report, model):
    """Seen from +z red is on the left; seen from -z red is on the right."""
    side = """(canvas) => {
      const { width, height } = canvas;
      const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
      let sum = 0;
      for (let i = 0; i < data.length; i += 4) {
        if (data[i] > 60 && data[i] > 2 * data[i + 1] && data[i] > 2 * data[i + 2]) sum += (i / 4) % width - width / 2;
      }
      return Math.sign(sum);
    }"""
    model.locator(".viewpoints").select_option("0")
    report.wait_for_timeout(300)
    assert eye(model)[0] == pytest.approx(0)
    assert model.locator("canvas").evaluate(side) == -1
    model.locator(".stage").focus()
    for _ in range(12):
        report.keyboard.press("ArrowRight")
    report.wait_for_timeout(300)
    assert eye(model)[0] == pytest.approx(180)
    assert model.locator("canvas").evaluate(side) == 1
    report.keyboard.press("Home")


def test_a_model_that_is_dragged_turns_with_the_pointer(report, model):
    stage = model.locator(".stage")
    stage.scroll_into_view_if_needed()
    box = stage.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    azimuth, elevation, zoom = eye(model)
    report.mouse.move(x, y)
    report.mouse.down()
    for step in range(1, 9):
        report.mouse.move(x + 9 * step, y + 3 * step)
    report.mouse.up()
    report.wait_for_timeout(300)
    degrees = 180 / model.locator("canvas").bounding_box()["width"]
    assert eye(model) == pytest.approx(
        (azimuth - 72 * degrees, elevation + 24 * degrees, zoom), abs=0.02
    )


def test_the_wheel_scrolls_the_page_until_a_model_is_chosen(report, model):
    stage = model.locator(".stage")
    stage.evaluate("one => one.blur()")
    stage.hover()
    before, top = eye(model), report.evaluate("scrollY")
    report.mouse.wheel(0, 40)
    report.wait_for_timeout(300)
    assert eye(model) == before
    assert report.evaluate("scrollY") != top
    stage.click()
    top = report.evaluate("scrollY")
    report.mouse.wheel(0, -40)
    report.wait_for_timeout(300)
    assert eye(model)[2] > before[2]
    assert report.evaluate("scrollY") == top


def test_the_imprint_of_a_touch_is_shown_on_focus_and_on_tap(report, model):
    buttons = model.locator(".touched button")
    felt = model.locator(".felt")
    model.locator(".viewpoints").select_option("1")
    assert buttons.count() == 5
    assert not felt.is_visible()
    buttons.nth(1).focus()
    assert felt.inner_text().startswith("Touch 2: edge 0.")
    assert model.locator('.touched [aria-pressed="true"]').inner_text() == "2"
    buttons.nth(3).click()
    assert felt.inner_text().startswith("Touch 4: ")
    background = felt.locator(".cell").evaluate("one => getComputedStyle(one).background")
    assert 'url("data:image/webp;base64,' in background
    assert "-288px -96px" in background
    report.mouse.move(0, 0)
    model.locator(".strategies").select_option("random")
    felt.wait_for(state="hidden", timeout=5000)
    model.locator(".viewpoints").select_option("all")
    assert buttons.count() == 4 * 5


def test_a_model_is_enlarged_and_escape_brings_it_back(report, model, keep):
    stage = model.locator(".stage")
    small = stage.bounding_box()["width"]
    button = model.get_by_label("Enlarge")
    button.press("Enter")
    assert button.get_attribute("aria-pressed") == "true"
    report.wait_for_timeout(500)
    assert stage.bounding_box()["width"] > 2 * small
    canvas = model.locator("canvas").first.bounding_box()
    assert canvas["width"] > 1.5 * small
    assert canvas["height"] < DESK["height"]
    keep(report, "model_enlarged")
    assert faults(report, ".model.large") == []
    button.press("Escape")
    report.wait_for_timeout(300)
    assert stage.bounding_box()["width"] == pytest.approx(small, abs=2)


def test_without_scripts_everything_can_be_read(visit, keep, folder):
    page = visit(folder / "report.html", scripts=False)
    keep(page, "report_without_scripts")
    for section in page.locator("main > section").all():
        assert section.locator("h2").is_visible()
    assert page.locator("article.object").count() == len(NAMES)
    page.locator("#methods summary").first.click()
    assert page.locator("#methods-text").is_visible()
    page.locator("article.object .fold > summary").first.click()
    assert not page.locator("button, input, select").locator("visible=true").count()
    views = page.locator("article.object .all-views").first
    assert not views.locator(".views").is_visible()
    views.locator("summary").click()
    assert views.locator(".views").is_visible()


def test_in_print_nothing_is_folded_away_and_nothing_waits_for_a_click(visit, folder):
    page = visit(folder / "report.html", "dark", scripts=False)
    page.emulate_media(media="print")
    for views in page.locator("article.object .views").all():
        assert views.locator("figure").first.bounding_box()["height"] > 50
    assert not page.locator("button, input, select, .skip").locator("visible=true").count()
    colour = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert colour == "rgb(253, 253, 251)"
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    printed = page.pdf(path=SCREENSHOTS / "report.pdf", format="A4", print_background=False)
    assert printed.startswith(b"%PDF")
