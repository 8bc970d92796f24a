"""What comes with the package is enough for a first recognition."""

import pytest

import visuohaptic as vh
from visuohaptic.base.errors import MeshError
from visuohaptic.exploration.examples import FOLDER, examples
from visuohaptic.exploration.recognising import PACKAGED_MODEL, touching_sections
from visuohaptic.meshes.catalogue import read_catalogue
from visuohaptic.parameters import ExperimentParameters


@pytest.fixture(scope="module")
def recogniser():
    return vh.read_recogniser(PACKAGED_MODEL)


def test_every_example_has_an_author_and_a_licence():
    credited = {model.key: model.credit for model in read_catalogue(FOLDER / "catalogue.csv")}
    assert sorted(credited) == sorted(vh.example(name).key for name in examples())
    assert all(credit.author and credit.licence for credit in credited.values())


def test_the_packages_model_knows_the_examples_classes_and_learnt_none_of_them(recogniser):
    assert set(examples()) < set(recogniser.model.classes)
    learnt = {"/".join(key) for key in recogniser.model.objects}
    assert not learnt & {vh.example(name).key for name in examples()}
    default = ExperimentParameters().model_dump(include=touching_sections())
    assert recogniser.parameters.model_dump(include=touching_sections()) == default


@pytest.mark.slow
@pytest.mark.parametrize("name", examples())
def test_an_example_is_recognised_in_one_line_with_its_class_in_the_set(name, recogniser):
    recognised = vh.example(name).touch().recognise(recogniser)
    assert next(iter(recognised.probabilities)) == name
    assert recognised.candidates[0] == name
    # One in ten objects of known classes is called unknown.
    assert recognised.unknown == (name == "bottle")
    assert recognised.name == ("unknown" if recognised.unknown else name)


def test_another_name_is_refused():
    with pytest.raises(MeshError, match="'mug' is no example; bottle, car, chair, quadruped"):
        vh.example("mug")
