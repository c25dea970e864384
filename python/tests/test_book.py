"""The book's chapter, and the README of project and package: every block of Python runs, in order."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import quell
import scipy.io

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("page", ["README.md", "docs/src/guide/python.md", "python/README.md"])
def test_every_block_runs(
    page: str,
    recording: quell.Recording,
    model: quell.Model,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    t, q, d = (recording["deformation"].stamps, recording["motor_position"].array, recording["deformation"].array)
    # What the reader of the page has.
    recording.save("arm7")
    model.save("model.toml")
    named = {"t": t, "q1_deg": np.rad2deg(q)}
    frame = pd.DataFrame({**named, "strain [mrad]": 1e3 * d})
    np.savez("log.npz", **named, log=np.stack([0.0 * d, 1e3 * d], axis=1))
    scipy.io.savemat("log.mat", {"log": {"t": t, "q": np.stack([q, d], axis=1)}})
    episodes = {
        "timestamp": np.concatenate([t, t]),
        "episode_index": np.repeat([0, 1], len(t)),
        "observation.state": list(np.tile(np.stack([q, d], axis=1), (2, 1))),
    }
    pq.write_table(pa.table(episodes), "episodes.parquet")
    Path("broken").mkdir()
    namespace = {"t": t, "q": q, "d": 1e3 * d, "frame": frame}
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    for number, block in enumerate(blocks):
        exec(compile(block, f"{page}, block {number + 1}", "exec"), namespace)
    # Each way to read is of the same numbers.
    read = namespace.get("recording", recording)
    np.testing.assert_allclose(read["deformation"].array, d, rtol=1e-12, atol=1e-18)
