"""What is launched, and the state of a launch."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class LaunchDescriptionEntity:
    """An action of a launch, or several."""


class LaunchDescription(LaunchDescriptionEntity):
    """The actions of a launch."""

    def __init__(self, entities: list[Any]) -> None:
        self.entities = entities


class LaunchContext:
    """The state of a launch."""

    def __init__(self) -> None:
        self.launch_configurations: dict[str, str] = {}
        self.is_shutdown = False
        self.handlers: list[Callable[[object, LaunchContext], Any]] = []
        self.tasks: set[Any] = set()
        self.on_shutdown: list[Callable[[], None]] = []

    def execute(self, entity: Any) -> None:
        """Executes an action, or those of a description."""
        for action in entity.entities if isinstance(entity, LaunchDescription) else [entity]:
            # Actions of the user's own have `visit`.
            getattr(action, "execute", getattr(action, "visit", None))(self)

    def emit(self, event: object) -> None:
        """Passes an event to its handlers, and executes the actions that these return."""
        for handler in list(self.handlers):
            action = handler(event, self)
            if action is not None:
                self.execute(action)

    def shut_down(self) -> None:
        """Stops the processes, once."""
        if not self.is_shutdown:
            self.is_shutdown = True
            for stop in self.on_shutdown:
                stop()

    def text(self, value: object) -> str:
        """Returns a text, also of a substitution."""
        perform = getattr(value, "perform", None)
        return str(value if perform is None else perform(self))
