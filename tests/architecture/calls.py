"""Ratchet of circles in the calls of a class: member functions of which each calls, through others, itself.

Members are told from their names: overloads are one function, and a call is a name of a member before a parenthesis that no other
object, namespace or type stands before. Of such a circle nobody says what is true when one of its functions is entered.
"""

import re

from sizes import CLASS, functions
from sources import code_of, cpp_files, module_of_file

CALL = re.compile(r"(\w+\s+)?(this->|(?<![\w.:~])(?<!->))(?:(\w+)::)?(\w+)\s*\(")
BEFORE_A_CALL = {"return", "else", "case", "throw", "co_return", "co_yield", "co_await", "do", "and", "or", "not"}
ONE_LINE = re.compile(r"^  (?! )[^;=]*?\b(\w+)\([^;{]*\)[^;{]*\{(.+)\}$")


def enclosing_classes(lines):
    """Class at the margin that each line is in, or None."""
    current = None
    for line in lines:
        match = CLASS.match(line)
        if match and not match.group(1):
            current = match.group(3)
        yield current
        if line.startswith("}"):
            current = None


def member_bodies(lines):
    """(class, member, text of its body) of the member functions that a file defines."""
    classes = list(enclosing_classes(lines))
    for number, name, length in functions(lines):
        owner = name.rpartition("::")[0].rpartition("::")[2] or classes[number - 1]
        if owner:
            # Behind the name: what the signature of a constructor initialises counts, its own name does not.
            text = "\n".join(lines[number - 1 : number - 1 + length]).partition(name)[2]
            yield owner, name.rpartition("::")[2], text[1:]
    for line, owner in zip(lines, classes):
        match = ONE_LINE.match(line)
        if match and owner:
            yield owner, match.group(1), match.group(2)


def called_names(text, owner):
    """Names that a body calls of its own class."""
    for match in CALL.finditer(text):
        before, this, scope, name = match.groups()
        declares = before and before.strip() not in BEFORE_A_CALL and not this
        if not declares and scope in (None, owner):
            yield name


def circles(graph):
    """Strongly connected components of more than one node (Tarjan), each sorted."""
    index, low, stack, on_stack, found = {}, {}, [], set(), []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        on_stack.add(node)
        for target in graph[node]:
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in on_stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            component = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            on_stack.difference_update(component)
            if len(component) > 1:
                found.append(sorted(component))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def find_call_cycles(root, _table):
    """(class, member with what it calls of its circle) of every member function that is in one."""
    bodies = {}
    for path in cpp_files(root):
        for owner, member, text in member_bodies(code_of(path).splitlines()):
            bodies.setdefault((module_of_file(path, root), owner), {}).setdefault(member, []).append(text)
    for (module, owner), members in sorted(bodies.items()):
        graph = {
            member: sorted({name for text in texts for name in called_names(text, owner) if name in members and name != member})
            for member, texts in members.items()
        }
        for component in circles(graph):
            for member in component:
                called = ", ".join(name for name in graph[member] if name in component)
                yield f"{module}::{owner}", f"{member} (calls {called})"
