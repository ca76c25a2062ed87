"""Names of machines, and which of them mean this one."""

import ipaddress
from urllib.parse import SplitResult, urlsplit


def is_loopback(host: str) -> bool:
    """Return whether a host name or address means this machine."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def hostname_of(host: str) -> str:
    """Return the name in a `Host` header, without its port; empty when it is no address."""
    parts = _split(f"//{host}")
    return parts.hostname or "" if parts else ""


def host_of_origin(origin: str) -> str:
    """Return what an `Origin` header would have as `Host`; empty when it is no address."""
    parts = _split(origin)
    return parts.netloc if parts else ""


def _split(address: str) -> SplitResult | None:
    try:
        return urlsplit(address)
    except ValueError:  # such as an unfinished [
        return None
