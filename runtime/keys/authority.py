"""A certificate authority of one's own, and a certificate for each part of a run, signed by it."""

import ipaddress
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Final

from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from common.bus.bus_keys import AUTHORITY, HUB, PARTS, KeysError, Part, pair_of

OWN_HOSTS: Final = ("localhost", "127.0.0.1", "::1")
"""Names of the hub on its own machine."""
EARLIER: Final = timedelta(hours=1)
"""How long before their creation certificates begin to be valid: another host's clock may be
behind."""
LABEL: Final = re.compile(r"[a-zA-Z0-9]([a-zA-Z0-9-]{0,61}[a-zA-Z0-9])?")


def make_keys(folder: Path, hosts: Sequence[str], days: int, *, force: bool = False) -> list[Path]:
    """Write the authority's certificate, and certificate and key of each part.

    The authority's own key is not kept: no more certificates can be signed.

    Args:
        folder: Created where missing.
        hosts: Names or addresses of the integrator's host, beside this machine's own.
        days: Validity of all certificates.
        force: Replace existing keys.

    Returns:
        The written files; keys have mode 0600.

    Raises:
        KeysError: When a host name is invalid, keys exist, or the folder cannot be written.
    """
    names = [_general_name(host) for host in (*OWN_HOSTS, *hosts)]
    paths = [folder / AUTHORITY, *(path for part in PARTS for path in pair_of(folder, part))]
    there = next((path for path in paths if path.exists()), None)
    if there is not None and not force:
        raise KeysError(
            f"{there} is there already: name another folder, or make all keys anew with --force "
            "(every host needs its new ones then)"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".keys-", dir=folder) as new:
            for name, content in _contents(names, days):
                _write(Path(new) / name, content)
            for path in paths:
                (Path(new) / path.name).replace(path)
    except OSError as error:
        raise KeysError(
            f"cannot write {error.filename or folder}: {error.strerror}; name another folder"
        ) from error
    return paths


def _contents(names: list[x509.GeneralName], days: int) -> Iterator[tuple[str, bytes]]:
    """Name and content of every file."""
    authority = ec.generate_private_key(ec.SECP256R1())
    begun = datetime.now(UTC) - EARLIER
    until = begun + EARLIER + timedelta(days=days)

    def signed(name: str, key: ec.EllipticCurvePublicKey) -> x509.CertificateBuilder:
        return (
            x509.CertificateBuilder(
                _name(_AUTHORITY), _name(name), key, x509.random_serial_number()
            )
            .not_valid_before(begun)
            .not_valid_after(until)
            .add_extension(x509.BasicConstraints(name == _AUTHORITY, None), critical=True)
        )

    root = signed(_AUTHORITY, authority.public_key()).sign(authority, SHA256())
    yield AUTHORITY, root.public_bytes(Encoding.PEM)
    for part in PARTS:
        key = ec.generate_private_key(ec.SECP256R1())
        made = signed(part, key.public_key()).add_extension(_usage(part), critical=False)
        if part == HUB:
            made = made.add_extension(x509.SubjectAlternativeName(names), critical=False)
        own = pair_of(Path(), part)
        yield own.certificate.name, made.sign(authority, SHA256()).public_bytes(Encoding.PEM)
        yield (
            own.key.name,
            key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()),
        )


_AUTHORITY: Final = "tritrack authority"


def _usage(part: Part) -> x509.ExtendedKeyUsage:
    """Only the hub's certificate is a server's: no other part can pose as the hub."""
    server, client = ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH
    return x509.ExtendedKeyUsage([server if part == HUB else client])


def _name(common: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common)])


def _general_name(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host.strip("[]")))
    except ValueError:
        if all(LABEL.fullmatch(label) for label in host.split(".")):
            return x509.DNSName(host)
    raise KeysError(f"{host!r} is no host: write a name as rig.local, or an address as 192.168.1.5")


def _write(path: Path, content: bytes) -> None:
    """A new file; a key is at no time readable by others."""
    mode = 0o600 if path.suffix == ".key" else 0o644
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
        file.write(content)
