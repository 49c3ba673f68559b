"""Python: what ``import smarig`` gives, and the packages below it that are meant for use. Sphinx writes the rest
from signatures and docstrings, when it reads these pages.
"""

import smarig
from generate.markdown import plain, table
from smarig.core import catalogue_names


def _controllers(package: str) -> list[str]:
    """A catalogue and its files: what is added to it appears here by itself."""
    return [package, *(f"{package}.{name}" for name in catalogue_names(package))]


PAGES: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "python_hysteresis": (
        "Python: hysteresis",
        "The operator and its kinds of density, without a wire.",
        (
            "smarig.preisach.operator",
            "smarig.preisach.state",
            "smarig.preisach.everett",
            "smarig.preisach.hysteresis.fod_surface",
            "smarig.preisach.hysteresis.gorbet_1997",
            "smarig.preisach.hysteresis.fod_table",
            "smarig.preisach.hysteresis.forc_table",
            "smarig.preisach.hysteresis.relay_measure",
            "smarig.preisach.hysteresis.mirrored",
        ),
    ),
    "python_theory": (
        "Python: state space, properties, energy",
        "Chapters 3, 4 and 7 of the thesis as functions.",
        (
            "smarig.theory.state_space",
            "smarig.theory.properties",
            "smarig.theory.energy",
            "smarig.theory.extended.restricted_operator",
            "smarig.theory.extended.nonlinear_operator",
            "smarig.theory.extended.moving_operator",
            "smarig.theory.extended.accommodating_operator",
            "smarig.theory.extended.reversible_operator",
            "smarig.theory.butterfly",
            "smarig.plant.stress",
        ),
    ),
    "python_data": (
        "Python: runs and data",
        "Runs as written, read, imported and exported.",
        ("smarig.record", "smarig.exchange", "smarig.core.sample"),
    ),
    "python_models": (
        "Python: models and diagnosis",
        "From runs to a model, its verification, and its diagnosis.",
        (
            "smarig.identification.identify",
            "smarig.replay.model_file",
            "smarig.identification.verify",
            "smarig.identification.verification",
            "smarig.replay.simulation",
            "smarig.identification.calibration.calibrate",
            "smarig.identification.forc.forc_density",
            "smarig.identification.positive",
            "smarig.identification.extended.choose_extension",
            "smarig.identification.extended.chord_test",
            "smarig.transformation.transformation_temperatures",
            "smarig.transformation.run_figures",
            "smarig.transformation.cycle_figures",
            "smarig.transformation.stress_dependence",
            "smarig.transformation.headline",
            "smarig.diagnosis.diagnose",
            "smarig.diagnosis.comparison.commanded.commanded_comparison",
            "smarig.diagnosis.comparison.commanded.commanded_diagnosis",
            "smarig.diagnosis.comparison.measured.measured_diagnosis",
        ),
    ),
    "python_control": (
        "Python: control",
        "Chapter 8: passivity, velocity feedback, set-points, tracking.",
        (
            "smarig.app.closed_loop",
            "smarig.certificate.passivity",
            "smarig.certificate.measured_passivity",
            "smarig.identification.run_passivity",
            "smarig.certificate.model_certificate",
            "smarig.control.position_feedback",
            "smarig.certificate.position_supply_rate",
            "smarig.certificate.position_assumptions",
            "smarig.control.velocity.velocity_controller",
            *_controllers("smarig.control.velocity.controllers"),
            "smarig.certificate.velocity.sampled_loop",
            "smarig.certificate.velocity.stability",
            "smarig.control.velocity.velocity_protocol",
            "smarig.certificate.rig_assessment",
            "smarig.control.regulation.anhysteretic_output",
            "smarig.control.regulation.approach",
            "smarig.control.regulation.setpoint_pi",
            "smarig.control.regulation.regulation_protocol",
            "smarig.control.tracking.controller_model",
            "smarig.control.tracking.reference",
            "smarig.control.tracking.tracking_performance",
            "smarig.control.tracking.tracking_protocol",
            "smarig.control.tracking.checked_controller",
            "smarig.control.tracking.pi_feedback",
            "smarig.control.tracking.heating_lag",
            "smarig.control.tracking.slope_observer",
            "smarig.control.tracking.tuning",
            *_controllers("smarig.control.tracking.controllers"),
        ),
    ),
    "python_seams": (
        "Python: interfaces for your own extensions",
        "The interfaces for protocols, effects, drivers and rigs.",
        (
            "smarig.core.command",
            "smarig.protocols._setup",
            "smarig.protocols._building_blocks",
            "smarig.plant.effect",
            "smarig.plant.effect_catalogue",
            "smarig.device.roles.ticked",
            "smarig.device.roles.polled",
            "smarig.device.polled.from_functions",
            "smarig.device.contract.driver_contract",
            "smarig.app.stepped_run",
            "smarig.rig.rig",
            "smarig.rig.twin",
            "smarig.runner.session",
            "smarig.runner.run_protocol",
            "smarig.runner.listener",
            "smarig.running.find_runs",
            "smarig.running.run_in_progress",
            "smarig.core.errors",
        ),
    ),
}


def pages() -> dict[str, str]:
    """A page of the public names, and one for each group of modules."""
    return {"python": _front()} | {name: _page(*page) for name, page in PAGES.items()}


def _front() -> str:
    rows = [
        (f"[{title.removeprefix('Python: ')}]({name}.md)", plain(lead))
        for name, (title, lead, _) in PAGES.items()
    ]
    names = "\n".join(_directive(name) for name in smarig.__all__)
    return f"""# Python

`import smarig` provides the names on this page. These pages describe the modules below them:

{table(("page", "holds"), rows)}
{names}"""


def _directive(name: str) -> str:
    kind = "class" if isinstance(getattr(smarig, name), type) else "function"
    options = "   :members:\n" if kind == "class" else ""
    return f"## {name}\n\n```{{eval-rst}}\n.. auto{kind}:: smarig.{name}\n{options}```\n"


def _page(title: str, lead: str, modules: tuple[str, ...]) -> str:
    chapters = "\n".join(
        f"## {module}\n\n```{{eval-rst}}\n.. automodule:: {module}\n   :members:\n```\n" for module in modules
    )
    return f"# {title}\n\n{lead}\n\n{chapters}"
