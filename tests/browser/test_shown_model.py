"""The page of `show` in a real browser."""

import pytest
import trimesh
from browser.conftest import PHONE
from browser.test_pages import eye, faults

import visuohaptic as vh

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The pages of an object and of its exploration, with a name that means harm."""
    folder = tmp_path_factory.mktemp("shown")
    trimesh.creation.torus(1, 0.4, 32, 16).export(folder / "<script>alert(1)ring.obj")
    ring = vh.load(folder / "<script>alert(1)ring.obj")
    felt = ring.touch(viewpoints=4, parameters={"rendering.resolution": 64})
    return {"object": ring.show(folder / "1.html"), "exploration": felt.show(folder / "2.html")}


@pytest.fixture(scope="module")
def model(visit, pages):
    figure = visit(pages["exploration"]).locator(".model")
    figure.locator("canvas").wait_for()
    return figure


def drawn(model):
    """Return the share of the drawing's pixels that are of surface, squares and numbers."""
    return model.locator("canvas").evaluate(
        """canvas => {
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          let count = 0;
          for (let i = 3; i < data.length; i += 4) count += data[i] > 0;
          return count / (canvas.width * canvas.height);
        }"""
    )


def test_keys_and_wheel_work_at_once(model, keep):
    page = model.page
    page.wait_for_timeout(300)
    keep(page, "shown_exploration")
    assert 0.1 < drawn(model) < 0.9
    azimuth, elevation, zoom = eye(model)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    model.locator(".stage").hover()
    page.mouse.wheel(0, -40)
    page.wait_for_timeout(300)
    turned = eye(model)
    assert turned[:2] == (azimuth + 15, elevation + 15)
    assert turned[2] > zoom
    page.keyboard.press("Home")
    page.wait_for_timeout(300)
    assert eye(model) == (azimuth, elevation, zoom)
    assert faults(page) == []


def test_a_drag_turns_the_model_and_its_touches(model, keep):
    page, stage = model.page, model.locator(".stage")
    box = stage.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before, shown = eye(model), stage.screenshot()
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 30, steps=5)
    page.mouse.up()
    page.wait_for_timeout(300)
    keep(page, "shown_exploration_dragged")
    azimuth, elevation, zoom = eye(model)
    assert azimuth < before[0]
    assert elevation > before[1]
    assert zoom == before[2]
    assert stage.screenshot() != shown


def test_a_view_stands_where_its_camera_stood_and_all_views_show_all_touches(model):
    views = model.locator(".viewpoints")
    assert model.locator(".strategies").is_hidden()
    views.select_option("1")
    model.page.wait_for_timeout(300)
    assert eye(model)[0] == pytest.approx(90)
    assert model.locator(".touched button").count() == 5
    views.select_option("all")
    assert model.locator(".touched button").count() == 20


def test_an_object_is_shown_on_a_phone_without_touches(visit, pages, keep):
    page = visit(pages["object"], "dark", PHONE)
    figure = page.locator(".model")
    figure.locator("canvas").wait_for()
    page.wait_for_timeout(300)
    keep(page, "shown_object_phone")
    assert drawn(figure) > 0.1
    assert eye(figure) == (30, 20, 1)
    assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    assert page.get_by_role("heading").inner_text() == "unknown/<script>alert(1)ring"
    assert figure.locator("select, .touched").count() == 0


def test_without_scripts_the_page_says_so(visit, pages):
    page = visit(pages["object"], scripts=False)
    assert page.get_by_text("With JavaScript the model can be turned here.").is_visible()
