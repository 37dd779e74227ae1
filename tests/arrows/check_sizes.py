#!/usr/bin/python3
"""Fails where a class or a function is too long to be read at once. The lines of a class are those of its declaration and of its member
definitions in all files, without the comments before them; those of a function run from its declaration to its last brace. A lambda and a
class that is declared in another count for what contains them. Before it
looks at the project, it measures sources whose sizes are known."""

from __future__ import annotations

import ast
import re
import sys
from bisect import bisect_right
from collections import defaultdict
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Optional, Tuple

ROOT = Path(__file__).resolve().parents[2]
MAX_CLASS_LINES = 350
MAX_FUNCTION_LINES = 80
# Folder -> endings of its sources.
SOURCES = {
    "engine": (".h", ".cpp"),
    "server": (".h", ".cpp"),
    "clients/cli": (".h", ".cpp"),
    "clients/python": (".py",),
    "clients/web": (".ts",),
}
LEFT_OUT = {"node_modules", "dist", "build", "test", "tests"}


class Piece(NamedTuple):
    """Lines of one file that are the declaration of a class, or a function with its body."""

    kind: str  #: "class", "function", or "member" for a function that is defined outside its class
    name: str
    path: str
    first: int
    last: int

    @property
    def lines(self) -> int:
        return self.last - self.first + 1


class Token(NamedTuple):
    text: str
    line: int


# --- C++ ---

CPP_TOKEN = re.compile(
    r"""//[^\n]*(?:\\\n[^\n]*)* | /\*.*?\*/                         # comments
      | (?P<raw>(?:u8|[uUL])?R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)")
      | (?P<text>(?:u8|[uUL])?"(?:[^"\\\n]|\\.)*"|(?<![0-9A-Za-z_])(?:u8|[uUL])?'(?:[^'\\\n]|\\.)+')
      | ^[ \t]*\#(?:[^\n\\]|\\.)*                                    # preprocessor
      | (?P<word>[A-Za-z_]\w*) | (?P<number>\.?\d(?:[\w.]|'\w)*)
      | (?P<mark2>->|::|&&|\|\||[{}()\[\];:,<>=~&*?.!+\-/%^|@])""",
    re.VERBOSE | re.DOTALL | re.MULTILINE)


def first_branches(text: str) -> str:
    """The text in which the lines of each #else and #elif are empty, so that its braces are balanced."""
    lines = text.split("\n")
    left_out = [False]  # for each #if around a line, whether the line is in another branch than the first
    for i, line in enumerate(lines):
        directive = re.match(r"\s*#\s*(if|el|endif)", line)
        if directive is None:
            lines[i] = "" if left_out[-1] else line
        elif directive[1] == "if":
            left_out.append(left_out[-1])
        elif len(left_out) > 1:
            if directive[1] == "el":
                left_out[-1] = True
            else:
                left_out.pop()
    return "\n".join(lines)


def tokens_of(text: str, pattern: "re.Pattern[str]") -> List[Token]:
    """Words and marks; a literal is the word `"`. Comments and preprocessor lines are left out."""
    ends = [match.start() for match in re.finditer("\n", text)]
    found = []
    for match in pattern.finditer(text):
        kind = match.lastgroup
        if kind is None:
            continue
        word = '"' if kind in ("raw", "text", "mark") else match.group()
        found.append(Token(word, bisect_right(ends, match.start() - 1) + 1))
    return found


def closing(tokens: List[Token], at: int) -> int:
    """Index of the bracket that closes the one at `at`; the last token if there is none."""
    pairs = {"{": "}", "(": ")", "[": "]"}
    stack = []
    for i in range(at, len(tokens)):
        text = tokens[i].text
        if text in pairs:
            stack.append(pairs[text])
        elif stack and text == stack[-1]:
            stack.pop()
            if not stack:
                return i
    return len(tokens) - 1


def after_template_lists(head: List[str]) -> List[str]:
    """The words of a declaration without `template <...>` and attributes at its beginning."""
    while head and head[0] in ("template", "[", "alignas"):
        opening, end = {"template": ("<", ">"), "[": ("[", "]"), "alignas": ("(", ")")}[head[0]]
        depth = round_depth = 0
        for i in range(0 if head[0] == "[" else 1, len(head)):
            if opening == "<":
                round_depth += (head[i] == "(") - (head[i] == ")")
            if round_depth == 0:
                depth += (head[i] == opening) - (head[i] == end)
            if depth == 0 and round_depth == 0:
                break
        head = head[i + 1:]
    return head


def class_name(head: List[str]) -> Optional[List[str]]:
    """The qualified name that a declaration's head gives to a class; none if it declares no class."""
    words = after_template_lists(head)
    if words and words[0] == "typedef":
        words = words[1:]
    if not words or words[0] not in ("class", "struct", "union"):
        return None
    words = after_template_lists(words[1:])
    name: List[str] = []
    depth = 0
    for word in words:
        if depth == 0 and word in (":", "final"):
            break
        if word == "(":
            return None  # a function that returns a `struct name`
        depth += (word == "<") - (word == ">")
        if depth == 0 and re.match(r"\w", word):
            name.append(word)
    return name or ["(unnamed)"]


def function_name(head: List[str]) -> Optional[List[str]]:
    """The qualified name of the function that a head defines; none if no body follows it."""
    words = after_template_lists(head)
    angle = depth = 0
    for i, word in enumerate(words):
        if word == "operator" and depth == 0:
            symbol = "".join(words[i + 1:i + 3]) if words[i + 1:i + 2] == ["("] else words[i + 1] if i + 1 < len(words) else ""
            return qualifiers(words, i) + ["operator" + symbol]
        if word == "(":
            if depth == 0 and angle == 0 and i > 0 and (re.match(r"\w", words[i - 1]) or words[i - 1] == ">"):
                if words[i - 1] in ("decltype", "noexcept", "explicit", "requires", "alignas"):
                    depth += 1
                    continue
                name = words[i - 1]
                before = i - 1
                if before > 0 and words[before - 1] == "~":
                    before, name = before - 1, "~" + name
                return qualifiers(words, before) + [name]
            depth += 1
        elif word == ")":
            depth -= 1
        elif depth == 0 and word == "<":
            angle += 1
        elif depth == 0 and word == ">":
            angle = max(0, angle - 1)
        elif depth == 0 and word == "=":
            return None
    return None


def qualifiers(words: List[str], at: int) -> List[str]:
    """The names before `words[at]` that `::` joins to it, without their template arguments."""
    names: List[str] = []
    while at >= 2 and words[at - 1] == "::":
        at -= 2
        if words[at] == ">":
            depth = 1
            while at > 0 and depth:
                at -= 1
                depth += (words[at] == ">") - (words[at] == "<")
            at -= 1
        names.insert(0, words[at])
    return names


def begins_body(head: List[str]) -> bool:
    """Whether a brace after this head of a function begins its body, and not the value of a member in its initializer list."""
    depth = 0
    parameters = False
    for i, word in enumerate(head):
        depth += (word in "([") - (word in ")]") if len(word) == 1 else 0
        if depth == 0 and word == ")":
            parameters = True
        if depth == 0 and parameters and word == ":":
            return head[-1] in (")", "}") and i + 1 < len(head)
    return True


def cpp_pieces(path: str, text: str) -> Iterator[Piece]:
    tokens = tokens_of(first_branches(text) if "#" in text else text, CPP_TOKEN)
    # Names of the namespaces and classes around the present token, and whether each is a class.
    scopes: List[Tuple[List[str], bool, int]] = []
    head: List[int] = []
    i = 0
    while i < len(tokens):
        word = tokens[i].text
        if word == ";":
            head = []
        elif word == "}":
            if scopes:
                names, is_class, first = scopes.pop()
                if is_class and not any(scope[1] for scope in scopes):
                    yield Piece("class", full_name(path, scopes, names), path, first, tokens[i].line)
            head = []
        elif word == "(" or word == "[":
            end = closing(tokens, i)
            head += range(i, end + 1)
            i = end
        elif word == ":" and [tokens[k].text for k in head] in (["public"], ["private"], ["protected"]):
            head = []
        elif word == "{":
            words = [tokens[k].text for k in head]
            first = tokens[head[0]].line if head else tokens[i].line
            plain = after_template_lists(words)
            name = class_name(words)
            if "namespace" in plain[:2] or plain[:1] == ["extern"] and plain[-1:] == ['"']:
                scopes.append(([w for w in plain[plain.index("namespace") + 1:] if w != "::"] or ["(unnamed)"]
                               if "namespace" in plain else [], False, first))
                head = []
            elif name is not None and "=" not in plain:
                scopes.append((name, True, first))
                head = []
            else:
                function = None if plain[:1] == ["enum"] else function_name(words)
                end = closing(tokens, i)
                if function is not None and begins_body(words):
                    kind = "member" if len(function) > 1 and not any(scope[1] for scope in scopes) else "function"
                    yield Piece(kind, full_name(path, scopes, function), path, first, tokens[end].line)
                    head = []
                else:
                    head += (i, end)  # what the braces contain does not matter
                i = end
        else:
            head.append(i)
        i += 1


def full_name(path: str, scopes: List[Tuple[List[str], bool, int]], names: List[str]) -> str:
    """A name with its namespaces. A name in an unnamed namespace belongs to its file."""
    around = [part for scope in scopes for part in scope[0]] + names
    text = "::".join(part for part in around if part != "(unnamed)" or part is names[-1])
    return f"{text} ({path})" if "(unnamed)" in around[:-1] else text


# --- TypeScript ---

TS_TOKEN = re.compile(
    r"""//[^\n]* | /\*.*?\*/
      | (?P<text>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|`(?:[^`\\$]|\\.|\$(?!\{))*`)
      | (?P<part>`(?:[^`\\$]|\\.|\$(?!\{))*\$\{)
      | (?P<regex>(?:(?<=[(,=:\[!&|?{};])|(?<=[(,=:\[!&|?{};]\s)|(?<=return\s))/(?![/*])(?:[^/\\\n\[]|\\.|\[(?:[^\]\\\n]|\\.)*\])+/[a-z]*)
      | (?P<word>[A-Za-z_$#][\w$]*) | (?P<number>\d[\w.]*)
      | (?P<mark2>=>|[{}()\[\];:,<>=?.!&|+\-*/@])""",
    re.VERBOSE | re.DOTALL)
TS_TEMPLATE_REST = re.compile(r"(?:[^`\\$]|\\.|\$(?!\{))*(?P<end>`|\$\{)", re.DOTALL)
NO_FUNCTIONS = {"if", "for", "while", "switch", "catch", "with", "return", "typeof", "await", "of", "in", "case", "new"}
TYPE_WORDS = {"is", "typeof", "keyof", "readonly", "extends", "asserts", "infer", "unique", "void"}


def ts_tokens(text: str) -> List[Token]:
    """Tokens as of `tokens_of`. The code between the braces of a template literal is read too."""
    ends = [match.start() for match in re.finditer("\n", text)]
    found: List[Token] = []
    templates: List[int] = []  # for each template literal that is open, the number of braces that are open in its code
    at = 0
    while at < len(text):
        match = TS_TOKEN.match(text, at)
        if match is None:
            at += 1
            continue
        line = bisect_right(ends, at - 1) + 1
        at = match.end()
        kind, word = match.lastgroup, match.group()
        if kind == "part":
            templates.append(0)
            found.append(Token('"', line))
        elif word == "}" and templates and templates[-1] == 0:
            rest = TS_TEMPLATE_REST.match(text, at)
            if rest is not None:
                at = rest.end()
            if rest is None or rest["end"] == "`":
                templates.pop()
        elif kind is not None:
            if templates and word in "{}":
                templates[-1] += 1 if word == "{" else -1
            found.append(Token('"' if kind in ("text", "regex") else word, line))
    return found


def ts_body(tokens: List[Token], at: int) -> Optional[int]:
    """The brace that begins the body of a function whose parameters end before `at`."""
    if at < len(tokens) and tokens[at].text == ":":
        at += 1
        after_name = False
        while at < len(tokens):
            word = tokens[at].text
            if word in ("{", "(", "["):
                if word == "{" and (after_name or tokens[at - 1].text in (")", "]", "}", ">", '"')):
                    return at
                at = closing(tokens, at)
                after_name = False
            elif re.match(r"[\w$]", word):
                if after_name and word not in TYPE_WORDS:
                    return None
                after_name = word not in TYPE_WORDS or word == "void"
            elif word in (";", ",", "=", ")", "}", "?"):
                return None
            else:
                after_name = False
            at += 1
        return None
    return at if at < len(tokens) and tokens[at].text == "{" else None


def ts_pieces(path: str, text: str) -> Iterator[Piece]:
    tokens = ts_tokens(text)
    for i, token in enumerate(tokens):
        before = tokens[i - 1].text if i else ""
        if token.text == "class" and before != "." and i + 1 < len(tokens) and tokens[i + 1].text not in (":", "=", ",", ")"):
            brace, depth = i, 0
            while brace < len(tokens) and (depth > 0 or tokens[brace].text != "{"):
                depth += (tokens[brace].text == "<") - (tokens[brace].text == ">")
                brace += 1
            if brace < len(tokens):
                yield Piece("class", f"{tokens[i + 1].text} ({path})", path, token.line, tokens[closing(tokens, brace)].line)
        elif token.text == "(":
            end = closing(tokens, i)
            named = bool(re.match(r"[\w$#]", before)) and before not in NO_FUNCTIONS or before == ">"
            brace = ts_body(tokens, end + 1) if named else None
            if brace is not None:
                yield Piece("function", f"{before} ({path})", path, token.line, tokens[closing(tokens, brace)].line)
        elif token.text == "=>" and i + 1 < len(tokens) and tokens[i + 1].text == "{":
            yield Piece("function", f"=> ({path})", path, token.line, tokens[closing(tokens, i + 1)].line)


# --- Python ---

def py_pieces(path: str, text: str) -> Iterator[Piece]:
    for node in ast.walk(ast.parse(text)):
        kind = ("class" if isinstance(node, ast.ClassDef) else
                "function" if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) else None)
        if kind is not None:
            yield Piece(kind, f"{node.name} ({path})", path, node.lineno, node.end_lineno or node.lineno)


READERS = {".h": cpp_pieces, ".cpp": cpp_pieces, ".py": py_pieces, ".ts": ts_pieces}


class Size(NamedTuple):
    lines: int
    kind: str
    name: str
    places: str


def sizes(sources: Dict[str, str]) -> List[Size]:
    """The sizes of all classes and functions, the largest first."""
    pieces = [piece for path, text in sources.items() for piece in READERS[Path(path).suffix](path, text)]
    classes: Dict[str, List[Piece]] = defaultdict(list)
    for piece in pieces:
        if piece.kind == "class":
            classes[piece.name].append(piece)
    for piece in pieces:
        name = piece.name.removesuffix(f" ({piece.path})")
        # Members of classes that are declared in others count for these, and a class's unnamed namespace may have ended.
        while piece.kind == "member" and "::" in name:
            name = name.rpartition("::")[0]
            owner = next((known for known in (name, f"{name} ({piece.path})") if known in classes), None)
            if owner is not None:
                classes[owner].append(piece)
                break
    found = [Size(piece.lines, "function", piece.name, f"{piece.path}:{piece.first}") for piece in pieces if piece.kind != "class"]
    found += [Size(sum(part.lines for part in parts), "class", name, ", ".join(sorted({part.path for part in parts})))
              for name, parts in classes.items()]
    return sorted(found, reverse=True)


def too_long(sources: Dict[str, str]) -> List[Size]:
    limits = {"class": MAX_CLASS_LINES, "function": MAX_FUNCTION_LINES}
    return [size for size in sizes(sources) if size.lines > limits[size.kind]]


def sources_of_project() -> Dict[str, str]:
    found = {}
    for folder, endings in SOURCES.items():
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in endings and not LEFT_OUT & set(path.parts[len(ROOT.parts):]):
                found[path.relative_to(ROOT).as_posix()] = path.read_text(encoding="utf-8")
    return found


# --- Self-test ---

CPP_SAMPLE = {
    "a.h": """#pragma once
namespace supple::room {
template <class T, int n = (1 < 2)>
class Shape final : public Base<T> {  // { in a comment
 public:
  explicit Shape(int n) : n_{n}, text_("{"), more_(n, [](int k) { return k; }) {
    n_ += 1;
  }
  int count() const { return n_; }
  struct Inner {
    int x = 0;
  };
  void draw(const std::function<int(int)>& f) const;

 private:
  int n_{0};
  std::string text_;
};
enum class Kind { a, b };
struct Plain;
constexpr std::array<int, sizeof(int)> numbers{1, 2};
}  // namespace supple::room
""",
    "a.cpp": """#include "a.h"
#define BROKEN { {
namespace supple::room {
namespace {
const char* const text = R"(} } {)";
class Hidden {
 public:
  void run();
};
void Hidden::run() {
  for (const char c : {'{', '"'}) use(c);
}
}  // namespace
/// Not counted.
template <class T, int n>
void Shape<T, n>::draw(
    const std::function<int(int)>& f) const {
  if (f(1'000)) {
    const auto g = [&] { return 1; };
  }
}
bool operator==(const Plain& a, const Plain& b) { return true; }
static const std::map<int, int> table = {
    {1, 2},
};
#ifdef FIRST
struct Plain make(int n) {
#else
struct Plain make(double n) {
#endif
  return {};
}
}  // namespace supple::room
""",
}
OTHER_SAMPLES = {
    "b.ts": """export class Panel extends Base<{ a: number }> {
  readonly text = `a ${this.f({ a: 1 })} }`;
  private pattern = /[{/]/g;
  f({ a }: { a: number }): { b: number } {
    return { b: a };
  }
}
export function far(x: number): Promise<void> | null {
  const inner = (y: number): number => {
    return x > 0 ? f(y) : { a: 1 };
  };
}
""",
    "c.py": """class Client:
    def get(self):
        return 1


async def wait():
    pass
""",
}
EXPECTED = {
    "class supple::room::Shape": 16 + 7,
    "class supple::room::Hidden (a.cpp)": 4 + 3,
    "function supple::room::Shape::Shape": 3,
    "function supple::room::Shape::count": 1,
    "function supple::room::Shape::draw": 7,
    "function supple::room::Hidden::run (a.cpp)": 3,
    "function supple::room::operator=": 1,
    "function supple::room::make": 6,
    "class Panel (b.ts)": 7,
    "function f (b.ts)": 3,
    "function far (b.ts)": 5,
    "function => (b.ts)": 3,
    "class Client (c.py)": 3,
    "function get (c.py)": 2,
    "function wait (c.py)": 2,
}


def self_test() -> List[str]:
    found = {f"{size.kind} {size.name}": size.lines for size in sizes({**CPP_SAMPLE, **OTHER_SAMPLES})}
    return [f"self-test: {name}: {found.get(name)} lines instead of {EXPECTED.get(name)}"
            for name in sorted(set(found) | set(EXPECTED)) if found.get(name) != EXPECTED.get(name)]


if __name__ == "__main__":
    wrong = self_test()
    project = sources_of_project()
    if len(project) < 100:
        wrong.append(f"only {len(project)} sources were found: the check looks in the wrong place")
    wrong += [f"{size.lines} lines: {size.kind} {size.name}: {size.places}" for size in too_long(project)]
    print("\n".join(wrong) if wrong else
          f"no class is above {MAX_CLASS_LINES} lines and no function above {MAX_FUNCTION_LINES}")
    sys.exit(1 if wrong else 0)
