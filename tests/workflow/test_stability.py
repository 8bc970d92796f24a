"""Every run checks its objects; what exceeds its tolerance is named at the end and in the report, and fails nothing."""

import pyarrow.compute as pc
import pytest
import trimesh
from small_experiment import SMALL_OBJECTS

from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

pytestmark = pytest.mark.workflow

RIGHT = "np.divide(planes[:, 3] - dot(planes, origins), along, out=distance, where=met)"
TAMPERED = f"{RIGHT}\n        distance *= 1 + 1e-9"


def test_every_run_checks_every_object(finished):
    own = read_table(STABILITY, finished.folder / "results/stability")
    assert set(own["object"].to_pylist()) == set(SMALL_OBJECTS)
    assert pc.all(pc.less_equal(own["worst_error"], own["tolerance"])).as_py()
    page = (finished.folder / "reports/report.html").read_text()
    assert "Objects of this run" in page
    assert "Hard cases of the code" in page


@pytest.mark.long
def test_blocks_of_viewpoints_change_no_check(finished, experiment):
    experiment.set(workflow={"views_per_job": 1})
    experiment.snakemake("--", "stability_all")
    before, after = (
        read_table(STABILITY, each.folder / "results/stability") for each in (finished, experiment)
    )
    assert after.equals(before)


@pytest.mark.long
def test_a_ray_caster_that_errs_is_named_at_the_end_and_on_the_page_and_fails_nothing(experiment):
    own = experiment.folder / "meshes/own/chair/stool.stl"
    own.parent.mkdir(parents=True, exist_ok=True)
    trimesh.creation.box((1, 2, 1)).export(own)
    caster = experiment.folder / "src/visuohaptic/geometry/raycasting.py"
    assert caster.read_text().count(RIGHT) == 1
    caster.write_text(caster.read_text().replace(RIGHT, TAMPERED))
    output = experiment.snakemake().stdout
    assert "warning: chair/stool: objects, hits lie on their face's plane: the worst" in output
    page = (experiment.folder / "reports/report.html").read_text()
    assert 'class="verdict broken"' in page
    assert ">chair/stool</a>: objects, hits lie on their face" in page
    assert experiment.planned() == {}
