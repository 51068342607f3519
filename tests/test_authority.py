"""Keys as they are made: what is written, for whom, and what is refused."""

import shutil
import ssl
import subprocess
from pathlib import Path

import pytest

pytest.importorskip("cryptography", reason="keys are an extra: install tritrack[keys]")

from common.bus.bus_keys import PARTS, KeysError
from runtime.keys.authority import make_keys


def openssl(*words: str | Path) -> subprocess.CompletedProcess[str]:
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed")
    return subprocess.run(["openssl", *words], capture_output=True, check=False, text=True)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "keys"
    make_keys(folder, ["rig.local", "192.168.1.5"], 30)
    return folder


def test_each_part_has_a_certificate_and_a_key_that_is_for_it_alone(made: Path) -> None:
    names = {"ca.pem", *(f"{part}.{kind}" for part in PARTS for kind in ("pem", "key"))}
    assert {path.name for path in made.iterdir()} == names
    assert {path.stat().st_mode & 0o777 for path in made.glob("*.key")} == {0o600}


def test_the_authoritys_own_key_is_kept_nowhere(made: Path) -> None:
    """Whoever reads all of the folder can still make no certificate that is trusted."""
    authority = ssl.create_default_context(cafile=str(made / "ca.pem"))
    assert len(authority.get_ca_certs()) == 1
    for key in made.glob("*.key"):
        with pytest.raises(ssl.SSLError):
            ssl.create_default_context().load_cert_chain(made / "ca.pem", key)


@pytest.mark.parametrize("part", PARTS)
def test_openssl_takes_each_certificate_for_its_purpose_and_no_other(made: Path, part: str) -> None:
    """Held against another program: who holds a client's certificate cannot pose as the hub."""

    def verified(purpose: str) -> bool:
        words = ("verify", "-CAfile", made / "ca.pem", "-purpose", purpose, made / f"{part}.pem")
        return openssl(*words).returncode == 0

    assert verified("sslserver") is (part == "integrator")
    assert verified("sslclient") is (part != "integrator")


@pytest.mark.parametrize("host", ["rig.local", "192.168.1.5", "localhost", "127.0.0.1", "::1"])
def test_the_integrator_is_known_by_each_of_its_names(made: Path, host: str) -> None:
    words = ("x509", "-noout", "-ext", "subjectAltName", "-in", made / "integrator.pem")
    assert {"::1": "0:0:0:0:0:0:0:1"}.get(host, host) in openssl(*words).stdout


def test_keys_that_are_there_are_kept_unless_they_shall_go(tmp_path: Path) -> None:
    make_keys(tmp_path, [], 30)
    before = (tmp_path / "client.key").read_bytes()
    (tmp_path / "ca.pem").unlink()
    with pytest.raises(KeysError, match=r"integrator\.pem is there already: .*--force"):
        make_keys(tmp_path, [], 30)
    assert (tmp_path / "client.key").read_bytes() == before
    assert not (tmp_path / "ca.pem").exists()
    make_keys(tmp_path, [], 30, force=True)
    assert (tmp_path / "client.key").read_bytes() != before
    assert (tmp_path / "client.key").stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("host", ["a b", "", "rig..local", "-rig", "http://rig", "rig:7447"])
def test_a_host_that_is_none_is_named_and_nothing_is_written(tmp_path: Path, host: str) -> None:
    with pytest.raises(KeysError, match="is no host: write a name"):
        make_keys(tmp_path / "keys", [host], 30)
    assert not (tmp_path / "keys").exists()


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "keys").write_text("")
    with pytest.raises(KeysError, match=r"cannot write .*keys: .*; name another folder"):
        make_keys(tmp_path / "keys", [], 30)
