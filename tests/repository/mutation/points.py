# SPDX-License-Identifier: GPL-3.0-or-later
"""The mutation points of a C++ file, found by libclang: its operators, literals, conditions, statements and returns."""
import dataclasses
import re

import clang.cindex
from clang.cindex import CursorKind as K
from clang.cindex import TypeKind

CALL = "landfall_mutant::"
RELATIONAL = {"<": ("less", "<=", ">="), "<=": ("less_equal", "<", ">"), ">": ("greater", ">=", "<="),
              ">=": ("greater_equal", ">", "<")}
ARITHMETIC = {"+": ("add", "-"), "-": ("subtract", "+"), "*": ("multiply", "/"), "/": ("divide", "*"),
              "%": ("remainder", "*"), "<<": ("shift_left", ">>"), ">>": ("shift_right", "<<"), "&": ("bit_and", "|"),
              "|": ("bit_or", "&"), "^": ("bit_xor", "&"), "==": ("equal", "!="), "!=": ("unequal", "==")}
ASSIGNMENT = {"+=": ("add_to", "-="), "-=": ("subtract_from", "+="), "*=": ("multiply_by", "/="),
              "/=": ("divide_by", "*="), "&=": ("and_into", "|="), "|=": ("or_into", "&="), "^=": ("xor_into", "|=")}
# Highway: functions of vectors whose arguments and results have the same types.
LANES = {"Add": ["Sub"], "Sub": ["Add"], "Mul": ["Add"], "Div": ["Mul"], "Ge": ["Gt", "Lt"], "Gt": ["Ge", "Le"],
         "Le": ["Lt", "Gt"], "Lt": ["Le", "Ge"], "Eq": ["Ne"], "And": ["Or"], "Or": ["And"], "Min": ["Max"], "Max": ["Min"],
         "Floor": ["Ceil"], "Abs": ["Neg"]}
ONLY_FOR_SPEED = {"reserve", "Prefetch", "shrink_to_fit"}
SKIPPED = {K.STATIC_ASSERT, K.ENUM_DECL, K.TYPE_ALIAS_DECL, K.TYPEDEF_DECL, K.TEMPLATE_TYPE_PARAMETER,
           K.TEMPLATE_NON_TYPE_PARAMETER, K.TEMPLATE_TEMPLATE_PARAMETER, K.USING_DECLARATION, K.USING_DIRECTIVE,
           K.TYPE_ALIAS_TEMPLATE_DECL, K.INCLUSION_DIRECTIVE, K.MACRO_DEFINITION, K.MACRO_INSTANTIATION, K.FRIEND_DECL}
FUNCTIONS = {K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.DESTRUCTOR, K.FUNCTION_TEMPLATE, K.CONVERSION_FUNCTION}
STATEMENTS = {K.COMPOUND_STMT, K.IF_STMT, K.FOR_STMT, K.WHILE_STMT, K.CXX_FOR_RANGE_STMT, K.DO_STMT, K.CASE_STMT,
              K.DEFAULT_STMT}
NUMBERS = {TypeKind.INT, TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG, TypeKind.DOUBLE,
           TypeKind.FLOAT, TypeKind.SHORT, TypeKind.USHORT, TypeKind.UCHAR, TypeKind.SCHAR, TypeKind.CHAR_S, TypeKind.BOOL}


@dataclasses.dataclass
class Mutant:
    kind: str  # relational, arithmetic, ...
    change: str  # `a < b` -> `a <= b`, for reports and for the key
    id: int = 0


@dataclasses.dataclass
class Point:
    """A piece of the source, and the parts that replace it: texts, in which @0 is the id of the first mutant, and pieces."""
    start: int
    end: int
    parts: list
    mutants: list
    function: str = ""
    line: int = 0
    named: tuple = ()  # where the constant is declared, if the point is a use of one


class Finder:
    def __init__(self, path, arguments):
        self.path = path
        with open(path, "rb") as file:
            self.text = file.read().decode("latin-1")
        index = clang.cindex.Index.create()
        self.unit = index.parse(path, args=arguments, options=1)
        self.errors = [str(d) for d in self.unit.diagnostics if d.severity >= clang.cindex.Diagnostic.Error]
        self.points = {}
        self.texts = {}
        self.constants = {}  # offset of the declaration -> Mutant
        self.top = [c for c in self.unit.cursor.get_children() if c.kind != K.MACRO_DEFINITION and self.is_here(c.extent)]
        self.macros = [self.extent(c) for c in self.top if c.kind == K.MACRO_INSTANTIATION]

    def find(self):
        for cursor in self.top:
            self.visit(cursor, None, "", None)
        return sorted(self.points.values(), key=lambda p: (p.start, -p.end))

    def is_here(self, extent):
        return extent.start.file is not None and extent.start.file.name == self.path

    def extent(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def source(self, piece):
        return self.text[piece[0]:piece[1]]

    def short(self, piece, most=60):
        text = " ".join(self.source(piece).split())
        return text if len(text) <= most else text[:most - 3] + "..."

    # Traversal

    def visit(self, cursor, parent, function, result):
        if cursor.kind in SKIPPED or cursor.kind.is_attribute():
            if cursor.kind == K.FRIEND_DECL:
                self.visit_children(cursor, function, result)
            return
        piece = self.extent(cursor)
        if not self.is_here(cursor.extent):  # for example a default argument
            return
        if piece[0] == piece[1] or any(a <= piece[0] and piece[1] <= b for a, b in self.macros):
            return
        if cursor.kind in FUNCTIONS:
            function, result = cursor.spelling, self.result_of(cursor)
        if cursor.kind == K.LAMBDA_EXPR:
            result = "auto"
        if cursor.kind in (K.VAR_DECL, K.FIELD_DECL) and self.is_constant(cursor):
            self.constant(cursor, function)
            return
        self.mutate(cursor, parent, piece, function, result)
        self.visit_children(cursor, function, result)

    def visit_children(self, cursor, function, result):
        children = list(cursor.get_children())
        if cursor.kind == K.CASE_STMT:
            children = children[1:]
        if cursor.kind == K.IF_STMT and re.match(r"if\s+constexpr", self.source(self.extent(cursor))):
            children = children[1:]
        if cursor.kind in (K.VAR_DECL, K.FIELD_DECL):
            children = [c for c in children if c.extent.start.offset > cursor.location.offset]
        for child in children:
            self.visit(child, cursor, function, result)

    def result_of(self, cursor):
        kind = cursor.result_type
        if cursor.kind in (K.CONSTRUCTOR, K.DESTRUCTOR) or kind.kind in (
                TypeKind.LVALUEREFERENCE, TypeKind.RVALUEREFERENCE, TypeKind.POINTER, TypeKind.VOID):
            return None
        spelled = kind.spelling.replace("(anonymous namespace)::", "")
        spelled = re.sub(r"landfall::N_\w+::", "", spelled)
        return re.sub(r"^(const|struct|class) ", "", spelled)

    def mutate(self, cursor, parent, piece, function, result):
        maker = {K.BINARY_OPERATOR: self.binary, K.CALL_EXPR: self.call, K.UNARY_OPERATOR: self.unary,
                 K.COMPOUND_ASSIGNMENT_OPERATOR: self.binary, K.INTEGER_LITERAL: self.literal, K.FLOATING_LITERAL: self.literal,
                 K.CXX_BOOL_LITERAL_EXPR: self.literal, K.RETURN_STMT: self.returned, K.DECL_REF_EXPR: self.use,
                 K.MEMBER_REF_EXPR: self.use}.get(cursor.kind)
        if parent is not None and parent.kind in STATEMENTS and self.is_statement(cursor, parent):
            self.removal(cursor, parent, piece, function)
        condition = self.condition_of(cursor)
        if condition is not None:
            self.negation(condition, function)
        if maker:
            maker(cursor, parent, piece, function, result)

    def put(self, piece, kind, parts, changes, function, named=()):
        key = (piece, kind)
        if key in self.points:
            return
        line = self.text.count("\n", 0, piece[0]) + 1
        self.points[key] = Point(*piece, parts, [Mutant(kind, change) for change in changes], function, line, named)

    # Operators

    def operands(self, cursor):
        """(left, operator, right) or None."""
        children = [c for c in cursor.get_children() if c.extent.start.offset != c.extent.end.offset]
        if cursor.kind == K.CALL_EXPR and len(children) == 3:
            left, right = sorted((children[0], children[2]), key=lambda c: c.extent.start.offset)
        elif len(children) == 2:
            left, right = children
        else:
            return None
        a, b = self.extent(left), self.extent(right)
        between = re.sub(r"//[^\n]*|/\*.*?\*/", "", self.text[a[1]:b[0]], flags=re.S).strip()
        return (a, between, b) if a[1] <= b[0] else None

    def binary(self, cursor, _parent, piece, function, _result):
        found = self.operands(cursor)
        if not found:
            return
        a, sign, b = found
        changed = lambda other: f"`{self.short(piece)}`: {sign} -> {other}"
        if sign in RELATIONAL:
            name, border, negated = RELATIONAL[sign]
            self.put(piece, "relational", [f"{CALL}{name}<@0>(", a, ", ", b, ")"], [changed(border), changed(negated)], function)
        elif sign in ARITHMETIC:
            name, other = ARITHMETIC[sign]
            kind = "relational" if sign in ("==", "!=") else "arithmetic"
            self.put(piece, kind, [f"{CALL}{name}<@0>(", a, ", ", b, ")"], [changed(other)], function)
        elif sign in ASSIGNMENT:
            name, other = ASSIGNMENT[sign]
            self.put(piece, "assignment", [f"{CALL}{name}<@0>(", a, ", ", b, ")"], [changed(other)], function)
        elif sign == "&&":
            self.put(piece, "logical", [f"({CALL}gate<@0>(", a, ") ? static_cast<bool>(", b, f") : {CALL}on<@0>())"],
                     [changed("||")], function)
        elif sign == "||":
            self.put(piece, "logical", [f"({CALL}gate<@0>(", a, f") ? !{CALL}on<@0>() : static_cast<bool>(", b, "))"],
                     [changed("&&")], function)
        if sign in ("&&", "||"):
            self.negation(a, function)
            self.negation(b, function)

    def call(self, cursor, parent, piece, function, result):
        text = self.source(piece)
        overloaded = cursor.spelling.startswith("operator") and cursor.spelling not in ("operator<<", "operator>>", "operator=")
        if overloaded and not re.search("string", cursor.type.get_canonical().spelling):
            self.binary(cursor, parent, piece, function, result)
        extreme = re.match(r"std::(min|max)\s*(<[^()]*>)?\s*\(", text)
        if extreme and not overloaded:
            name, kind = extreme[1], extreme[2]
            call = f"{CALL}{name}_as<@0, {kind[1:-1]}>(" if kind else f"{CALL}{name}<@0>("
            other = "max" if name == "min" else "min"
            self.put(piece, "extreme", [call, (piece[0] + extreme.end(), piece[1])],
                     [f"`{self.short(piece)}`: {name} -> {other}"], function)
        lane = re.match(r"hn::(\w+)\(", text)
        if lane and lane[1] in LANES:
            arguments = (piece[0] + lane.end(), piece[1])
            for_each = []
            for i, other in enumerate(LANES[lane[1]]):
                for_each += [f"{CALL}on<@{i}>() ? hn::{other}(", arguments, " : "]
            self.put(piece, "lanes", ["(", *for_each, f"hn::{lane[1]}(", arguments, ")"],
                     [f"`{self.short(piece)}`: {lane[1]} -> {other}" for other in LANES[lane[1]]], function)
        if lane and lane[1] == "IfThenElse":
            children = [self.extent(c) for c in cursor.get_children()][-3:]
            if len(children) == 3:
                self.put(piece, "lanes", [f"({CALL}on<@0>() ? hn::IfThenElse(", children[0], ", ", children[2], ", ", children[1],
                                          ") : hn::IfThenElse(", children[0], ", ", children[1], ", ", children[2], "))"],
                         [f"`{self.short(piece)}`: branches swapped"], function)

    def unary(self, cursor, _parent, piece, function, _result):
        child = next(cursor.get_children(), None)
        if child is None:
            return
        inside = self.extent(child)
        sign = self.text[piece[0]:inside[0]].strip()
        if sign == "-":
            self.put(piece, "arithmetic", [f"{CALL}minus<@0>(", inside, ")"], [f"`{self.short(piece)}`: - removed"], function)
        elif sign == "!":
            self.put(piece, "logical", [f"!{CALL}condition<@0>(", inside, ")"], [f"`{self.short(piece)}`: ! removed"], function)

    # Conditions, constants

    def condition_of(self, cursor):
        if cursor.kind not in (K.IF_STMT, K.WHILE_STMT, K.CONDITIONAL_OPERATOR):
            return None
        if re.match(r"if\s+constexpr", self.source(self.extent(cursor))):
            return None
        first = next((c for c in cursor.get_children()), None)
        return self.extent(first) if first is not None and first.kind.is_expression() else None

    def negation(self, piece, function):
        """Adds the negation of a condition without other mutants."""
        text = self.source(piece)
        plain = re.sub(r"\([^()]*\)|\[[^\[\]]*\]|<[^<>()=&|]*>|->", "", text)
        plain = re.sub(r"\([^()]*\)", "", plain)
        if not re.search(r"[<>!=&|]|^\(", plain):
            self.put(piece, "condition", [f"{CALL}condition<@0>(", piece, ")"], [f"`{self.short(piece)}` negated"], function)

    def literal(self, cursor, parent, piece, function, _result):
        text = self.source(piece)
        before, after = self.text[:piece[0]].rstrip()[-1:], self.text[piece[1]:].lstrip()[:1]
        is_argument = before in "<[" and after in ">]" and not self.is_index(piece)
        if is_argument or not re.match(r"[0-9.tf]", text):
            return
        if parent is not None and parent.kind in (K.DECL_REF_EXPR, K.MEMBER_REF_EXPR, K.TYPE_REF, K.TEMPLATE_REF):
            return
        if text in ("true", "false"):
            change = {"true": "false", "false": "true"}[text]
        elif cursor.kind == K.INTEGER_LITERAL:
            change = {"0": "1", "1": "0"}.get(text, f"{text} + 1")
        else:
            change = f"-{text}" if re.search("[1-9]", text) else "1"
        context = self.line_around(piece)
        self.put(piece, "constant", [f"{CALL}value<@0>(", piece, ")"], [f"{text} -> {change} in `{context}`"], function)

    def is_index(self, piece):
        return re.search(r"[\w)\]]\[$", self.text[:piece[0]].rstrip()) is not None

    def line_around(self, piece):
        start = self.text.rfind("\n", 0, piece[0]) + 1
        end = self.text.find("\n", piece[1])
        column = piece[0] - start
        line = self.text[start:end]
        return " ".join(line.split()) if len(line.split()) < 14 else " ".join(line[max(0, column - 40):column + 40].split())

    def is_constant(self, cursor):
        return re.search(r"\bconstexpr\b", self.text[cursor.extent.start.offset:cursor.location.offset]) is not None

    def constant(self, cursor, function):
        piece = self.extent(cursor)
        text = self.source(piece)
        kind = cursor.type.get_canonical()
        if kind.kind in NUMBERS and "NaN" not in text and "Nan" not in cursor.spelling:
            change = f"`{self.short(piece)}` changed"
            self.constants[cursor.location.offset] = Mutant("constant", change), function
        elif kind.kind == TypeKind.CONSTANTARRAY and kind.element_type.kind in NUMBERS:
            word = re.search(r"\bconstexpr\b", text)
            self.put((piece[0] + word.start(), piece[0] + word.end()), "array", ["const"], [], function)
            for literal in cursor.walk_preorder():
                if literal.kind in (K.INTEGER_LITERAL, K.FLOATING_LITERAL) and literal.extent.start.offset > cursor.location.offset:
                    inside = self.extent(literal)
                    if not self.text[:inside[0]].endswith("["):
                        self.put(inside, "constant", [f"{CALL}value_in_array<@0>(", inside, ")"],
                                 [f"{self.source(inside)} changed in `{self.short(piece)}`"], function)

    def use(self, cursor, parent, piece, function, _result):
        declared = cursor.referenced
        if declared is None or declared.kind != K.VAR_DECL or declared.location.file is None:
            return
        if declared.type.get_canonical().kind not in NUMBERS or self.source(piece).endswith(")"):
            return
        if not self.is_declared_constexpr(declared):
            return
        before, after = self.text[:piece[0]].rstrip()[-1:], self.text[piece[1]:].lstrip()[:1]
        if (before in "<," and after in ">") or (before == "[" and after == "]" and not self.is_index(piece)):
            return
        where = (declared.location.file.name, declared.location.offset)
        self.put(piece, "use", [f"{CALL}value<@0>(", piece, ")"], [], function, where)

    def is_declared_constexpr(self, declared):
        name = declared.location.file.name
        if name not in self.texts:
            with open(name, "rb") as file:
                self.texts[name] = file.read().decode("latin-1")
        return "constexpr" in self.texts[name][declared.extent.start.offset:declared.location.offset]

    # Statements

    def is_statement(self, cursor, parent):
        if not (cursor.kind.is_expression() or cursor.kind in (K.BREAK_STMT, K.CONTINUE_STMT, K.RETURN_STMT)):
            return False
        children = list(parent.get_children())
        index = [c.extent.start.offset for c in children].index(cursor.extent.start.offset)
        if parent.kind == K.COMPOUND_STMT:
            return True
        if parent.kind in (K.FOR_STMT, K.CXX_FOR_RANGE_STMT, K.WHILE_STMT, K.CASE_STMT, K.DEFAULT_STMT):
            return index == len(children) - 1
        if parent.kind == K.IF_STMT:
            return index > 0 and not self.is_condition(children, index, parent)
        return False

    def is_condition(self, children, index, parent):
        """True for the condition of an if that has an initializer, False for its statements."""
        closing = self.text[:children[index].extent.start.offset].rstrip()
        return not (closing.endswith(")") or closing.endswith("else"))

    def removal(self, cursor, parent, piece, function):
        text = self.source(piece)
        if cursor.kind in (K.BREAK_STMT, K.CONTINUE_STMT) or (cursor.kind == K.RETURN_STMT and text == "return"):
            self.jump_removal(parent, piece, function)
            return
        if cursor.kind == K.RETURN_STMT:
            return
        called = re.match(r"[\w:.>()\[\]-]*?(\w+)\(", text)
        if called and called[1] in ONLY_FOR_SPEED:
            return
        kind = cursor.kind
        while kind == K.UNEXPOSED_EXPR:
            cursor = next(cursor.get_children(), None)
            if cursor is None:
                break
            kind = cursor.kind
        self.put(piece, "statement", [f"({CALL}on<@0>() ? (void)0 : (void)(", piece, "))"] if kind != K.CXX_THROW_EXPR else
                 [f"({CALL}on<@0>() ? (void)0 : ", piece, ")"], [f"`{self.short(piece)}` removed"], function)

    def jump_removal(self, parent, piece, function):
        if parent.kind == K.IF_STMT and len(list(parent.get_children())) > 2:
            return
        end = self.text.index(";", piece[0]) + 1
        self.put((piece[0], end), "statement", [f"{{ if (!{CALL}on<@0>()) ", (piece[0], end), " }"],
                 [f"`{self.source(piece)}` removed"], function)

    def returned(self, cursor, _parent, piece, function, result):
        child = next(cursor.get_children(), None)
        if child is None or result is None:
            return
        inside = (piece[0] + len("return "), piece[1])
        text = self.source(inside)
        if result == "bool" and (re.search(r"[<>!=&|]", text) or text in ("true", "false")):
            return  # an equivalent mutant exists already
        if text.startswith("{"):
            if result == "auto":
                return
            parts = [f"{CALL}returned<@0, {result}>({result}", inside, ")"]
        elif result == "auto":
            parts = [f"{CALL}returned<@0>(", inside, ")"]
        else:
            parts = [f"{CALL}returned<@0, {result}>(", inside, ")"]
        if text in ("{}", "std::nullopt"):
            return
        self.put(inside, "return", parts, [f"returns a default, not `{self.short(inside)}`"], function)
