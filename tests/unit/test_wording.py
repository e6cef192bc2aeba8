"""Tests name codes, keys and numbers of messages, not their wording: prose that they compare with is counted."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

TESTS = Path(__file__).parents[1]
PROSE = re.compile(r"(?<![\w.])[A-Za-z]{2,}(?: [A-Za-z]{2,}){2,}")
"""Three words or more with a blank between; of a whole value that is equal, five: names of key figures have three."""
SENTENCE = re.compile(r"(?<![\w.])[A-Za-z]{2,}(?: [A-Za-z]{2,}){4,}")
PATTERNS = ("filterwarnings", "re.search", "re.match", "re.fullmatch", ".startswith", ".endswith")
BAR = 40

SAMPLE = """
@pytest.mark.filterwarnings("ignore:.*came to no end")
@pytest.mark.parametrize(("value", "words"), [(1, "must be longer here"), (2, "hinge_line.HL1.motor")])
def test_sample(value, words):
    with pytest.raises(SceneError, match="no such thing here"):
        use(value)
    with pytest.raises(SceneError, match=words):
        use(value)
    for words in ("it is far too long", r"motor\\.table"):
        assert words in message
    assert f"{value} is more than {limit}, which is too long" in message
    assert message == "the motor of HL1 is in the way of the latch and must move"
    assert headline["latch torque peak"] == values
    assert "hinge_line.HL1.motor: " in message
"""


def compared(tree: ast.AST) -> Iterator[tuple[ast.AST, re.Pattern[str]]]:
    """Expressions that a message is compared with."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield from ((keyword.value, PROSE) for keyword in node.keywords if keyword.arg == "match")
            if ast.unparse(node.func).endswith(PATTERNS):
                yield from ((argument, PROSE) for argument in (*node.args, *node.keywords))
        elif isinstance(node, ast.Compare):
            if isinstance(node.ops[0], ast.In | ast.NotIn):
                yield node.left, PROSE
            elif isinstance(node.ops[0], ast.Eq | ast.NotEq):
                yield node, SENTENCE


def values(function: ast.FunctionDef, names: set[str]) -> Iterator[ast.AST]:
    """Expressions that names of a test stand for: columns of its parameters, rows of its loops, what is assigned."""
    for call in function.decorator_list:
        if isinstance(call, ast.Call) and ast.unparse(call.func).endswith("parametrize"):
            parameters = re.findall(r"\w+", ast.unparse(call.args[0]))
            rows = call.args[1].elts if isinstance(call.args[1], ast.List | ast.Tuple) else [call.args[1]]
            for row in rows:
                cells = row.args if isinstance(row, ast.Call) else getattr(row, "elts", [row])
                yield from (cell for name, cell in zip(parameters, cells, strict=False) if name in names)
    for node in ast.walk(function):
        target = getattr(node, "target", None) if isinstance(node, ast.For | ast.comprehension) else None
        if target is not None and names & names_of(target):
            yield node.iter
        if isinstance(node, ast.Assign) and names & set().union(*map(names_of, node.targets)):
            yield node.value


def names_of(tree: ast.AST) -> set[str]:
    """Names within an expression."""
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def pinned(source: str) -> dict[tuple[int, int], str]:
    """Prose that a file compares messages with, by line and column."""
    tree = ast.parse(source)
    expressions = list(compared(tree))
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            names = set().union(*(names_of(part) for part, sought in compared(function) if sought is PROSE))
            expressions += ((value, PROSE) for value in values(function, names))
    return {
        (node.lineno, node.col_offset): node.value
        for expression, sought in expressions
        for node in ast.walk(expression)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and sought.search(node.value)
    }


def test_few_tests_pin_prose():
    """House rule: below 40 strings of prose in all tests; messages are recognized by code, key, name and number."""
    places = [
        f"{path.relative_to(TESTS)}:{line}: {text}"
        for path in sorted(TESTS.rglob("*.py"))
        if path.name != Path(__file__).name
        for (line, _), text in sorted(pinned(path.read_text(encoding="utf-8")).items())
    ]
    print(*places, len(places), sep="\n")
    assert len(places) < BAR


def test_prose_is_counted():
    """Control: each way in which a test can pin prose counts once; keys and names of figures do not."""
    assert [line for line, _ in sorted(pinned(SAMPLE))] == [2, 3, 5, 9, 11, 12]
