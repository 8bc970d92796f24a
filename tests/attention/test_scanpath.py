import numpy as np
import pytest
from attention.displays import as_views

from visuohaptic.attention import AttentionParameters, scan

SIZE = 96
ROWS, COLUMNS = np.mgrid[:SIZE, :SIZE]
PANEL = as_views(np.zeros((SIZE, SIZE, 3)))


def flat_panel(saliency, mask=PANEL["mask"][0], parameters=None):
    surface = (mask, PANEL["point"][0], PANEL["normal"][0], ROWS * SIZE + COLUMNS)
    seen = [part[: len(saliency)] for part in surface]
    return scan(saliency.astype(np.float32), *seen, parameters or AttentionParameters())


def bump(row, column, height=1.0, width=3.0):
    return height * np.exp(-((ROWS - row) ** 2 + (COLUMNS - column) ** 2) / (2 * width**2))


def test_peaks_are_visited_from_the_highest_down():
    places = [(20, 70), (50, 20), (75, 75)]
    heights = [0.6, 1.0, 0.8]
    saliency = sum(bump(*place, height) for place, height in zip(places, heights, strict=True))
    path = flat_panel(saliency, parameters=AttentionParameters(fixations=3))
    np.testing.assert_array_equal(path.rows, [50, 75, 20])
    np.testing.assert_array_equal(path.columns, [20, 75, 70])
    np.testing.assert_allclose(path.saliency, [1.0, 0.8, 0.6], atol=1e-5)
    np.testing.assert_array_equal(path.faces, path.rows * SIZE + path.columns)
    np.testing.assert_allclose(path.points[0], [20 / SIZE, -50 / SIZE, 0.0])
    assert not path.exhausted


def test_return_is_inhibited_within_a_fraction_of_the_longer_edge_of_the_image():
    saliency = (bump(24, 20) + bump(24, 34, 0.9) + bump(24, 60, 0.8))[:48]
    parameters = AttentionParameters(
        fixations=2, inhibition="image", focus_fraction=0.2, inhibition_falloff=0.0
    )
    path = flat_panel(saliency, parameters=parameters)
    # The radius is 0.2 * 96 = 19 pixels: more than 34 - 20, less than 60 - 20.
    np.testing.assert_array_equal(path.columns, [20, 60])


def test_a_peak_on_the_outline_is_fixated_a_margin_inside():
    path = flat_panel(bump(48, 30), mask=COLUMNS >= 30)
    # The margin is 0.016 * 96 = 1.5 pixels; column 30 is one pixel from the outside, 31 two.
    assert (path.rows[0], path.columns[0]) == (48, 31)
    assert path.columns.min() == 31


@pytest.mark.parametrize("noise", [0.0, 1e-7, 1e-6])
def test_of_equal_peaks_the_upper_left_wins_despite_rounding(noise):
    rng = np.random.default_rng(3)
    saliency = bump(30, 70) + bump(30, 25) + bump(70, 48) + noise * rng.random((SIZE, SIZE))
    path = flat_panel(saliency, parameters=AttentionParameters(fixations=3))
    assert path.columns[0] in (25, 70)
    assert path.rows[2] == 70
    again = flat_panel(saliency + 1e-7 * rng.random((SIZE, SIZE)))
    np.testing.assert_array_equal(path.columns, again.columns[:3])


def test_small_object_is_exhausted_and_repeats_nothing():
    mask = (ROWS - 48) ** 2 + (COLUMNS - 48) ** 2 < 12**2
    path = flat_panel(bump(48, 48), mask, AttentionParameters(fixations=5, focus_radius=0.2))
    assert path.exhausted
    assert 1 <= path.distinct < 5
    assert len(set(zip(path.rows.tolist(), path.columns.tolist(), strict=True))) == path.distinct


def test_thin_rod_is_fixated_along_its_middle():
    mask = np.abs(COLUMNS - 48) <= 2
    path = flat_panel(np.ones((SIZE, SIZE)), mask, AttentionParameters(focus_radius=0.1))
    assert path.distinct == 5
    assert np.abs(path.columns - 48).max() <= 1


def test_flat_map_is_fixated_first_in_the_middle_of_the_object():
    mask = (ROWS - 48) ** 2 + (COLUMNS - 48) ** 2 < 40**2
    path = flat_panel(np.zeros((SIZE, SIZE)), mask)
    assert np.hypot(path.rows[0] - 48, path.columns[0] - 48) < 3
    assert path.distinct == 5


def test_in_the_rim_the_drive_returns_by_a_smooth_step():
    # A focus of 0.1 * 96 = 9.6 pixels. Peak B is a quarter of the rim outside: 1.25 foci from A.
    saliency = bump(48, 20) + bump(48, 32, 0.9, 1.0) + bump(48, 75, 0.2, 1.0)
    saliency -= bump(48, 20) * (COLUMNS > 26)
    parameters = AttentionParameters(fixations=3, inhibition="image", focus_fraction=0.1)
    path = flat_panel(saliency, parameters=parameters)
    # The share there is 3 / 4² - 2 / 4³ = 0.156, so that 0.9 counts 0.14: less than 0.2. By a linear rim it is 0.23.
    assert path.columns[:2].tolist() == [20, 75]
    np.testing.assert_allclose(path.saliency[:2], [1.0, 0.2], atol=1e-3)
    lower = flat_panel(saliency - bump(48, 75, 0.09, 1.0), parameters=parameters)
    assert lower.columns[0] == 20
    assert 32 <= lower.columns[1] <= 34


def test_pixels_at_the_focus_radius_are_closed_and_beyond_it_open():
    saliency = bump(48, 20, width=0.5) + bump(48, 30, 0.9, 0.5) + bump(48, 51, 0.8, 0.5)
    parameters = AttentionParameters(
        fixations=3, inhibition="image", focus_fraction=10 / 96, inhibition_falloff=0.0
    )
    path = flat_panel(saliency, parameters=parameters)
    # Column 30 is one radius from column 20.
    assert path.columns[:2].tolist() == [20, 51]
    smaller = parameters.model_copy(update={"focus_fraction": 9.9 / 96})
    assert flat_panel(saliency, parameters=smaller).columns.tolist() == [20, 30, 51]


@pytest.mark.parametrize(("distance", "winner"), [(10, 50), (11, 40)])
def test_of_tied_drives_the_largest_within_a_focus_radius_of_the_first_wins(distance, winner):
    saliency = bump(40, 20, 1.0 - 5e-5, 0.5) + bump(40 + distance, 20, 1.0, 0.5)
    parameters = AttentionParameters(fixations=1, inhibition="image", focus_fraction=10.7 / 96)
    # Drives tie within 1e-4. Both peaks are equally far from the outline.
    path = flat_panel(saliency, parameters=parameters)
    assert path.rows.tolist() == [winner]
