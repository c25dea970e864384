"""A patched model: its MJCF, its tables, and what it cannot hold."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .._result import Result, bold, paragraph, table
from ._laws import Law

__all__ = ["Change", "Patched"]

CALLBACK = '''\
import json, mujoco, numpy as np

model = mujoco.MjModel.from_xml_path("model.xml")
LAWS = [(law, [model.joint(name) for name in law["joints"]]) for law in json.load(open("laws.json"))]

def passive(model, data):
    for law, joints in LAWS:
        of = (lambda j: data.qpos[j.qposadr[0]]) if law["coordinate"] == "position" else (lambda j: data.qvel[j.dofadr[0]])
        force = np.interp(sum(of(j) for j in joints), law["points"], law["values"])
        for j in joints:
            data.qfrc_passive[j.dofadr[0]] += force

mujoco.set_mjcb_passive(passive)
'''


@dataclass(frozen=True)
class Change:
    """
    A number of the model that the patch sets.

    Parameters
    ----------
    element : str
        Kind and name of the element, such as `joint elbow`.
    attribute : str
        The attribute, such as `frictionloss`.
    before : str
        Its value in the given model; empty where the element is new.
    after : str
        Its value in the patched one.
    why : str
        The effect, or the refitted parameter.
    """

    element: str
    attribute: str
    before: str
    after: str
    why: str


@dataclass(frozen=True, eq=False)
class Patched(Result):
    """
    A MuJoCo model with what was found.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    xml : str
        The MJCF.
    changes : tuple of Change
        What is different.
    laws : tuple of Law
        What MJCF has no element for, for a callback.
    lacks : tuple of str
        What was found and is neither in the MJCF nor in the laws, with why.
    bends : dict of str to str
        The joints that are elastic, each with the joint that is its deformation: the link stands at the sum.
    spec : mujoco.MjSpec
        The same model, for further changes.
    """

    xml: str
    changes: tuple[Change, ...]
    laws: tuple[Law, ...]
    lacks: tuple[str, ...]
    bends: dict[str, str] = field(default_factory=lambda: dict[str, str]())
    spec: Any = field(default=None, repr=False)

    def model(self) -> Any:
        """
        Compile the patched model.

        Returns
        -------
        mujoco.MjModel
            The model; `install` adds the laws.
        """
        return self.spec.copy().compile()

    @property
    def callback(self) -> str:
        """The lines that apply `laws.json` in a simulation; empty where the MJCF holds all."""
        return CALLBACK if self.laws else ""

    def passive(self, model: Any) -> Any:
        """
        Make the callback that applies the laws.

        Parameters
        ----------
        model : mujoco.MjModel
            The patched model, or one that has its joints.

        Returns
        -------
        callable
            For `mujoco.set_mjcb_passive`.
        """
        laws = [(law, *_addresses(model, law)) for law in self.laws]

        def apply(_: Any, data: Any) -> None:
            for law, qpos, dofs in laws:
                where = data.qpos[qpos] if law.coordinate == "position" else data.qvel[dofs]
                data.qfrc_passive[dofs] += law(float(where.sum()))

        return apply

    def save(self, folder: str | Path) -> Path:
        """
        Write `model.xml`, and where there are laws `laws.json` and `apply.py`.

        Parameters
        ----------
        folder : str or Path
            The folder, which is made where it is not there. Its files of the same names are written over.

        Returns
        -------
        Path
            The folder.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.xml").write_text(self.xml, encoding="utf-8")
        if self.laws:
            laws = json.dumps([law.to_dict() for law in self.laws])
            (folder / "laws.json").write_text(laws + "\n", encoding="utf-8")
            (folder / "apply.py").write_text(CALLBACK, encoding="utf-8")
        return folder

    def _repr_html_(self) -> str:
        rows = [[one.element, one.attribute, one.before, one.after, one.why] for one in self.changes]
        laws = [[law.effect, " + ".join(law.joints), law.coordinate] for law in self.laws]
        tables = table(["element", "attribute", "before", "after", "why"], rows)
        if laws:
            tables += table(["table for a callback", "joints", "over"], laws)
        return bold("Patched") + tables + "".join(paragraph(lack) for lack in self.lacks)


def _addresses(model: Any, law: Law) -> tuple[list[int], list[int]]:
    joints = [model.joint(name) for name in law.joints]
    return [int(joint.qposadr[0]) for joint in joints], [int(joint.dofadr[0]) for joint in joints]
