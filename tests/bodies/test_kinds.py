"""The list of bodies: every kind is public and answers all questions."""

import inspect

import pytest

import fastpin
from fastpin import MATERIALS, bodies
from fastpin.bodies.body import PinBody, PlateBody
from fastpin.bodies.kinds import KINDS, PINS, PLATES
from tests.support.bodies import JOINTS, UNLIKE, joint_problem


def test_every_body_is_public():
    assert sorted(made.__name__ for made in KINDS.values()) == sorted(bodies.__all__)
    assert "bodies" in dir(fastpin)
    assert all(kind == made.kind for kind, made in KINDS.items())


@pytest.mark.parametrize(("base", "kinds"), [(PinBody, PINS), (PlateBody, PLATES)])
def test_bodies_answer_nothing_that_no_one_asks(base, kinds):
    """A method without a question in the protocol is one of the body's own: private, of its shape, or of its file."""
    own = {"held", "check_material", "around", "layer", "has_seat"}  # the support of a rim, and the parts of a bush
    of_file = {"order", "digest", "from_file", "from_document", "document", "to_text", "columns_of", "scaled_to"}
    of_file.add("own_loads")
    for made in kinds.values():
        names = {name for name, value in vars(made).items() if inspect.isfunction(value) or isinstance(value, property)}
        asked = {name for name in names - own - of_file if not name.startswith("_")}
        assert {name for name in asked if not hasattr(base, name)} == set()


@pytest.mark.parametrize("name", JOINTS)
def test_the_keys_of_a_body_are_those_that_it_writes(name):
    problem = joint_problem(name, 0.1, 0.3)
    for body in (problem.pin_body, problem.plate_body):
        written = {"E" if key == "material" else key for key in body.toml()}
        assert written <= set(type(body).keys)


def test_the_bodies_of_the_live_page_fit_the_hole():
    for kind, made in PLATES.items():
        if made.title:
            body = made.usual(1.0, MATERIALS["steel"])
            problem = fastpin.Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=body)
            assert problem.plate_body.kind == kind
