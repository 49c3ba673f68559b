"""A folder that no command may touch: programs that leave a mark, files to overwrite, secrets, and rigs that name them.

The commands run *in* this folder, so that relative names lead to it too.
"""

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from hostile.material import SECRET, Material

VICTIM = "years of work\n" * 10
_PROTOCOL = """from pathlib import Path
Path({mark!r}).write_text("executed")
def {name}(*_, **__):
    yield None
"""
_LIBRARY = (
    "#include <stdio.h>\n__attribute__((constructor)) static void f(void)"
    '{{ FILE *o = fopen("{mark}", "w"); if (o) fclose(o); }}\n'
)
_SERIAL = 'name = "one_wire_serial"\nbase = "one_wire_serial"\n'
_TWIN = 'name = "one_wire_twin"\nbase = "one_wire_twin"\n'
_LOADED = 'name = "one_wire_thermomechanical"\nbase = "one_wire_thermomechanical"\n'
_LINK = '[links.amplifier]\ndriver = "{driver}"\nframing = "lines"\nurl = "{url}"\n{more}'


@dataclass(frozen=True)
class Canaries:
    """The folder, and what is in it."""

    folder: Path

    @property
    def mark(self) -> Path:
        """Exists if a program of the folder was executed."""
        return self.folder / "MARK"

    def path(self, name: str) -> str:
        """The absolute path of a file in it."""
        return str(self.folder / name)

    def rig_texts(self) -> dict[str, str]:
        """A rig file by the key through which it leads to another file, a program or an address."""

        def link(driver: str = "smarig_amplifier", url: str = "", more: str = "") -> str:
            return _SERIAL + "[simulator]\nstart = false\n" + _LINK.format(driver=driver, url=url, more=more)

        visa = f'[links.amplifier.settings]\nbackend = "{self.path("evil.so")}@ivi"\n'
        return {
            "rig: base": f'name = "one_wire_twin"\nbase = "{self.path("base.toml")}"\n',
            "rig: actuator": _TWIN + f'actuator = "{self.path("actuator.toml")}"\n',
            "rig: load.file": _LOADED + f'[load]\nfile = "{self.path("load.csv")}"\n',
            "rig: load.formula": _LOADED + '[load]\nformula = "20 + t"\n',
            "rig: links.DEVICE.driver": link(self.path("evil.py")),
            "rig: links.DEVICE.url": link(url="socket://127.0.0.1:9"),
            "rig: links.DEVICE.settings": link("visa_supply", "TCPIP0::192.0.2.1::INSTR", visa),
            "rig: links.DEVICE.url with file=": link(url=f"spy://loop://?file={self.path('victim.csv')}"),
            "rig: simulator.library": _SERIAL + f'[simulator]\nlibrary = "{self.path("evil.so")}"\n',
            "rig: simulator.faults": _SERIAL + f'[simulator]\nfaults = "{self.path("secret.toml")}"\n',
            "rig: simulator.trace": _SERIAL + f'[simulator]\ntrace = "{self.path("victim.csv")}"\n',
        }

    def rig(self, key: str) -> str:
        """The path of the rig file of a key."""
        return self.path("_".join(re.findall(r"\w+", key)) + ".toml")

    @cached_property
    def before(self) -> dict[str, bytes]:
        """Every file with its contents."""
        return self._contents()

    def _contents(self) -> dict[str, bytes]:
        files = [p for p in self.folder.rglob("*") if p.is_file()]
        return {str(p.relative_to(self.folder)): p.read_bytes() for p in files}

    def changes(self) -> list[str]:
        """What was changed, deleted or made since the folder was filled."""
        now = self._contents()
        return sorted(
            name for name in now.keys() | self.before.keys() if now.get(name) != self.before.get(name)
        )

    def restore(self) -> None:
        """As it was filled."""
        for name in self.changes():
            path = self.folder / name
            if name in self.before:
                path.write_bytes(self.before[name])
            else:
                path.unlink()


def fill(folder: Path, m: Material) -> Canaries:
    """Fill a folder. Without a C compiler the library is no library; an attempt to load it is noticed all the same."""
    (folder / "home").mkdir(parents=True)
    c = Canaries(folder)
    for name in ("evil", "validation", "settling"):  # also under names of smarig
        (folder / f"{name}.py").write_text(_PROTOCOL.format(mark=str(c.mark), name=name))
    (folder / "evil.c").write_text(_LIBRARY.format(mark=c.mark))
    (folder / "evil.so").write_bytes(b"\x7fELF")
    if compiler := shutil.which("cc") or shutil.which("gcc"):
        words = [compiler, "-shared", "-fPIC", "-o", c.path("evil.so"), c.path("evil.c")]
        subprocess.run(words, check=True)
    (folder / "victim.csv").write_text(VICTIM)
    (folder / "secret.toml").write_text(f'{SECRET} = "{SECRET}"\n')
    (folder / "secret.csv").write_text("temperature_K\n30\n60\n20\n")
    (folder / "load.csv").write_text("time_s,force_N\n0,20\n100,20\n")
    (folder / "data.csv").write_bytes((m.folder / "good.csv").read_bytes())
    rig, actuator = m.text("rig.toml"), m.text("actuator.toml")
    for name in (
        "one_wire_twin",
        "base.toml",
    ):  # a file of the present folder under the name of a rig of smarig
        (folder / name).write_text(rig)
    for name in ("gorbet_one_wire", "actuator.toml"):
        (folder / name).write_text(actuator)
    for key, text in c.rig_texts().items():
        Path(c.rig(key)).write_text(text)
    shutil.copy(c.rig("rig: links.DEVICE.driver"), folder / "rig.toml")
    shutil.copy(folder / "rig.toml", folder / "home" / "rig.toml")
    (folder / "campaign.toml").write_text(
        f'name = "c"\nsummary = "s"\n[[step]]\nprotocol = "{c.path("evil.py")}"\n'
    )
    for name in ("whole.run.sqlite", "m.model.json"):
        shutil.copy(m.folder / name, folder / name)
    if os.name != "nt":
        os.mkfifo(folder / "pipe")
    assert c.before
    return c
