"""Tests name codes, keys and numbers of messages, not their wording: prose that they compare with is counted."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

TESTS = Path(__file__).parents[1]
PROSE = re.compile(r"(?<![\w.])[A-Za-z]{2,}(?: [A-Za-z]{2,}){2,}(?!\w)")
"""Three words or more with a blank between; of a whole value that is equal, five: names of key figures have three."""
SENTENCE = re.compile(r"(?<![\w.])[A-Za-z]{2,}(?: [A-Za-z]{2,}){4,}(?!\w)")
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
            if isinstance(node.ops[0], ast.In | ast.NotIn) and not isinstance(node.left, ast.Tuple):
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


def values_of_compared(function: ast.FunctionDef) -> list[ast.AST]:
    """Expressions that names in comparisons stand for, and those that names in these stand for."""
    names: set[str] = set().union(*(names_of(part) for part, sought in compared(function) if sought is PROSE))
    while True:
        found = list(values(function, names))
        more = names.union(*map(names_of, found))
        if more == names:
            return found
        names = more


def texts(tree: ast.AST) -> Iterator[ast.Constant]:
    """Strings within an expression, without the keys of tables, which name cases."""
    if isinstance(tree, ast.Constant) and isinstance(tree.value, str):
        yield tree
    for part in tree.values if isinstance(tree, ast.Dict) else ast.iter_child_nodes(tree):
        yield from texts(part)


def names_of(tree: ast.AST) -> set[str]:
    """Names within an expression, without those of places in a table."""
    if isinstance(tree, ast.Name):
        return {tree.id}
    parts = [tree.value] if isinstance(tree, ast.Subscript) else ast.iter_child_nodes(tree)
    return set().union(*map(names_of, parts))


def pinned(source: str) -> dict[tuple[int, int], str]:
    """Prose that a file compares messages with, by line and column."""
    tree = ast.parse(source)
    expressions = list(compared(tree))
    tables = {
        name: node.value
        for node in tree.body
        if isinstance(node, ast.Assign)
        for name in names_of(node.targets[0])
    }
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            for part in values_of_compared(function):
                expressions.append((part, PROSE))
                for name in names_of(part) & tables.keys():
                    table = tables[name]
                    of_keys = isinstance(part, ast.Name) and isinstance(table, ast.Dict)
                    expressions += ((one, PROSE) for one in (table.keys if of_keys else [table]))
    return {
        (node.lineno, node.col_offset): node.value
        for expression, sought in expressions
        for node in texts(expression)
        if "\n" not in node.value and sought.search(node.value)
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
