# The compiled part. Private: the tests run each call, with arguments that
# _arrays.py has prepared.

from typing import Any

version: str

class Changing:
    def __enter__(self) -> None: ...
    def __exit__(self, *of_exception: Any) -> None: ...

def __getattr__(name: str) -> Any: ...
