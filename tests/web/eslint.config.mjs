// SPDX-License-Identifier: GPL-3.0-or-later
import js from "@eslint/js";
import globals from "globals";

// The forms that python/landfall/web.py cannot join, or would join into one scope without seeing a name.
const unjoinable = {
  "Program > VariableDeclaration[declarations.length>1], ExportNamedDeclaration > VariableDeclaration[declarations.length>1]":
    "Declare one name at a time at the top level.",
  "Program > BlockStatement": "No block at the top level.",
  "ImportDefaultSpecifier, ImportNamespaceSpecifier, ExportAllDeclaration, ExportDefaultDeclaration, ExportSpecifier":
    "Only `import {a} from \"./b.js\"` and exported declarations.",
};

export default [
  js.configs.recommended,
  {
    languageOptions: {ecmaVersion: 2022, sourceType: "module", globals: globals.browser},
    linterOptions: {reportUnusedDisableDirectives: "error"},
    rules: {
      "no-restricted-syntax": ["error", ...Object.entries(unjoinable).map(([selector, message]) => ({selector, message}))],
      "eqeqeq": "error", "no-var": "error", "prefer-const": ["error", {destructuring: "all"}], "no-shadow": "error", "no-duplicate-imports": "error",
      "no-use-before-define": ["error", {functions: false, classes: false, variables: false}], "curly": ["error", "multi-line"],
      "max-len": ["error", {code: 170}], "max-lines-per-function": ["error", 60], "max-lines": ["error", 400],
      "no-implicit-globals": "error", "no-eval": "error", "no-implied-eval": "error", "no-param-reassign": "error",
      "no-restricted-properties": ["error", {property: "innerHTML"}, {property: "outerHTML"}, {property: "insertAdjacentHTML"}, {object: "document", property: "write"}],
    },
  },
];
