"""Checks of keys: missing, expired, of another authority, or readable by others."""

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Final

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.serialization import load_pem_private_key

from common.bus.bus_keys import AUTHORITY, HUB, PARTS, Part, pair_of
from tritrack.doctor.installation import Finding

SOON: Final = timedelta(days=14)
ANEW: Final = "make all keys anew (tritrack keys FOLDER --force) and copy them to every host"
ELSEWHERE: Final = "needed on the host where it runs"
COPY: Final = "copy it from where the keys were made, or make all anew (tritrack keys FOLDER)"


def examine_keys(folder: Path, now: datetime | None = None) -> list[Finding]:
    """Check the authority and every part; a host needs only the files of its own parts.

    Args:
        folder: The keys' folder.
        now: Time to check dates against, with a time zone; None: the clock's.
    """
    now = now or datetime.now(UTC)
    path = folder / AUTHORITY
    try:
        authority = x509.load_pem_x509_certificate(path.read_bytes())
    except (OSError, ValueError) as error:
        return [Finding(f"keys: {AUTHORITY}", False, _why(error, path), COPY)]
    found = [_dated(AUTHORITY, authority, now)]
    here = [part for part in PARTS if any(path.exists() for path in pair_of(folder, part))]
    if not here:
        return [*found, Finding("keys", False, f"no part's keys in {folder}", COPY)]
    for part in PARTS:
        if part in here:
            found.append(_examined(folder, part, authority, now))
        else:
            found.append(Finding(f"keys: {part}", False, "not here", ELSEWHERE, needed=False))
    return found


def _examined(folder: Path, part: Part, authority: x509.Certificate, now: datetime) -> Finding:
    """The first fault of a part's certificate or key, or its date of expiry."""
    what, own = f"keys: {part}", pair_of(folder, part)
    try:
        path = own.certificate
        certificate = x509.load_pem_x509_certificate(path.read_bytes())
        path = own.key
        key = load_pem_private_key(path.read_bytes(), password=None)
    except (OSError, ValueError, TypeError) as error:
        return Finding(what, False, _why(error, path), COPY)
    mode = own.key.stat().st_mode & 0o777
    if mode & 0o077:
        cure = f"chmod 600 {own.key}; if others have read it, {ANEW}"
        return Finding(what, False, f"{own.key} is readable by others (mode {mode:o})", cure)
    if key.public_key() != certificate.public_key():
        return Finding(what, False, f"{own.key} is not the key of {own.certificate}", COPY)
    try:
        certificate.verify_directly_issued_by(authority)
    except (ValueError, TypeError, InvalidSignature):
        detail = f"{own.certificate} is not signed by {folder / AUTHORITY}"
        return Finding(what, False, detail, COPY)
    if certificate.subject.rfc4514_string() != f"CN={part}":
        detail = f"{own.certificate} is of {certificate.subject.rfc4514_string()}"
        return Finding(what, False, detail, COPY)
    return _dated(part, certificate, now)


def _dated(name: str, certificate: x509.Certificate, now: datetime) -> Finding:
    begins, ends = certificate.not_valid_before_utc, certificate.not_valid_after_utc
    what, day = f"keys: {name}", f"{ends:%Y-%m-%d %H:%M} UTC"
    if now < begins:
        detail = f"holds from {begins:%Y-%m-%d %H:%M} UTC on, which is yet to come"
        return Finding(what, False, detail, "set this host's clock")
    if now > ends:
        return Finding(what, False, f"expired on {day}", ANEW)
    if now > ends - SOON:
        return Finding(what, False, f"expires on {day}", ANEW)
    return Finding(what, True, f"until {day}{_hosts(certificate) if name == HUB else ''}")


def _hosts(certificate: x509.Certificate) -> str:
    """The names and addresses of the integrator in its certificate."""
    named = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    return "; for " + ", ".join(str(name.value) for name in named)


def _why(error: Exception, path: Path) -> str:
    if isinstance(error, OSError):
        return f"cannot read {path}: {(error.strerror or str(error)).lower()}"
    return f"{path} holds no certificate or key"
