#!/usr/bin/env python3
"""api/openapi.yaml keeps the rules of openapi_lint.py, and each rule finds a document that breaks it."""
import copy
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests/support"))

import openapi_lint as lint  # noqa: E402
from contract import Contract  # noqa: E402


class OpenApi(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.contract = Contract()

    def findings(self, document):
        return lint.findings(document, Contract(document).errors, ROOT)

    def test_the_document_keeps_the_rules(self):
        self.assertEqual(self.findings(self.contract.document), [])

    def test_each_rule_finds_what_breaks_it(self):
        def job(document):
            return document["paths"]["/v1/jobs/{id}"]

        breaks = {
            "objects_have_their_shape": lambda d: job(d)["get"].update(sumary="x"),
            "nothing_is_cut_at_a_comma": lambda d: d["tags"][0].update(watch=None),
            "operations_say_what_they_do": lambda d: job(d)["get"].update(summary="no sentence"),
            "paths_have_their_parameters": lambda d: job(d).update(parameters=[]),
            "answers_are_described": lambda d: d["components"]["responses"]["NotFound"].update(content={"text/plain": {}}),
            "problems_have_examples": lambda d: d["components"]["responses"]["NotFound"]["content"]["application/problem+json"].pop("example"),
            "bodies_have_examples": lambda d: d["paths"]["/v1/jobs/batch"]["post"]["requestBody"]["content"]["application/json"].pop("example"),
            "examples_are_valid": lambda d: d["components"]["responses"]["NotFound"]["content"]["application/problem+json"]["example"].update(status=200),
            "components_are_used": lambda d: d["components"]["schemas"].update(Nobody={"type": "object"}),
            "statuses_of_the_server_are_documented": lambda d: d["x-answers-where-there-is-no-operation"].pop("417"),
            "codes_of_errors_are_documented": lambda d: d["components"]["schemas"]["problem_document"]["$defs"]["error"]["properties"]["code"]["oneOf"].pop(),
        }
        self.assertEqual(set(breaks), {rule.__name__ for rule in (*lint.RULES, *lint.RULES_OF_THE_SERVER)})
        for rule, do_break in breaks.items():
            document = copy.deepcopy(self.contract.document)
            do_break(document)
            self.assertTrue(any(found.startswith(rule) for found in self.findings(document)), rule)


if __name__ == "__main__":
    unittest.main(verbosity=2)
