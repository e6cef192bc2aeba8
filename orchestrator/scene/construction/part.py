"""What every table of a body's construction is made of, and the types of its values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails

from ..table import Table

Problem = tuple[tuple[str | int, ...], str]
"""Place within a table, and a sentence."""


def _as_part(schema: dict[str, Any], table: type[PartTable]) -> None:
    """Keys are `needed` of a whole body, not required of a table; those of a choice stand `instead` of each other."""
    choices = {key: keys for keys in table.choices for key in keys}
    for key, keys in choices.items():
        schema["properties"][key]["instead"] = [other for other in keys if other != key]
    schema["needed"] = schema.pop("required", [])


class PartTable(Table):
    """A table of a body's construction; an entry of the catalogue or another body may have the keys that it omits."""

    model_config = ConfigDict(json_schema_extra=_as_part)
    choices: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys of which exactly one is given."""

    def contradictions(self) -> Iterator[Problem]:
        """What cannot be of keys that are sound one by one."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _consistent(cls, data: object, validated: ModelWrapValidatorHandler[Self]) -> Self:
        problems: list[Any] = []

        def note(place: tuple[str | int, ...], sentence: str) -> None:
            details = InitErrorDetails(
                type="value_error", loc=place, input=data, ctx={"error": ValueError(sentence)}
            )
            problems.append(details)

        for sentence in cls._wrong_choices(data) if isinstance(data, Mapping) else ():
            note((), sentence)
        try:
            table = validated(data)
            for place, sentence in () if problems else table.contradictions():
                note(place, sentence)
        except ValidationError as error:
            problems = [*error.errors(), *problems]
        if problems:
            raise ValidationError.from_exception_data(cls.__name__, problems)
        return table

    @classmethod
    def _wrong_choices(cls, data: Mapping[str, object]) -> Iterator[str]:
        for keys in cls.choices:
            given = [key for key in keys if data.get(key) is not None]
            if len(given) != 1:
                yield f"give one of {', '.join(keys)}; it has {' and '.join(given) or 'none'}"


def _once(values: tuple[Any, ...]) -> tuple[Any, ...]:
    if len({*values}) < len(values):
        raise ValueError(f"is {[*values]}; give none twice")
    return values


def at_least(fewest: int) -> AfterValidator:
    """Annotation of a list of so many entries or more."""

    def check(values: tuple[Any, ...]) -> tuple[Any, ...]:
        if len(values) < fewest:
            raise ValueError(f"has {len(values) or 'no'} entries; give {fewest} or more")
        return values

    return AfterValidator(check)


Count = Annotated[int, Field(ge=1, strict=True)]
Flag = Annotated[bool, Field(strict=True)]
Names = Annotated[tuple[str, ...], AfterValidator(_once)]
NodeNumbers = Annotated[tuple[Count, ...], AfterValidator(_once), at_least(1)]
