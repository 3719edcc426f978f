from typing import Any

def uncorrelated(
    image: Any, halvings: int, wanted: list[Any], energies: list[Any], shares: list[Any], faintest: float, slope: Any
) -> float: ...
