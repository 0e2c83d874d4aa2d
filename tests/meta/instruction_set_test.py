"""The programs run on any x86-64 server of the last fifteen years: no instruction
beyond x86-64-v2, neither AVX nor BMI, but in functions that are called where the
processor has it and say so in their names.

    instruction_set_test.py PROGRAM…"""

import re
import subprocess
import sys
import unittest

# AVX and FMA begin with v and know wider registers; the rest is BMI and others of
# x86-64-v3. (tzcnt is an old bsf to those that do not know it.)
BEYOND = re.compile(r"\t(v(?!err\b|erw\b|mcall\b)[a-z0-9]+|andn|bextr|bls[ir]|blsmsk|bzhi|lzcnt"
                    r"|mulx|pdep|pext|rorx|sarx|shlx|shrx|movbe)\b|%[yz]mm")
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
DISPATCHED = "WithAvx2"
PROGRAMS = []


def find_beyond(assembly):
    """Instructions, as a disassembler writes them, that not every server has."""
    function = ""
    found = []
    for line in assembly.splitlines():
        if match := FUNCTION.match(line):
            function = match[1]
        elif DISPATCHED not in function and BEYOND.search(line):
            found.append(f"{function}: {line}")
    return found


class InstructionSetTest(unittest.TestCase):
    def test_knows_what_is_beyond(self):
        self.assertEqual(find_beyond("  1:\tmulsd  %xmm0,%xmm1\n  2:\tverr   %ax\n"), [])
        for line in ("  1:\tvmulsd %xmm0,%xmm1,%xmm1", "  1:\tshlx   %rax,%rbx,%rcx",
                     "  1:\tvmovaps %ymm0,(%rax)"):
            self.assertEqual(find_beyond("12 <f>:\n" + line), [f"f: {line}"])
            self.assertEqual(find_beyond("12 <fWithAvx2>:\n" + line), [])

    def test_no_program_needs_it(self):
        if not PROGRAMS:
            self.skipTest("no program given")
        for program in PROGRAMS:
            assembly = subprocess.run(["objdump", "--disassemble", "--no-show-raw-insn", program],
                                      check=True, capture_output=True, text=True).stdout
            self.assertGreater(assembly.count("\n"), 10_000)
            self.assertEqual(find_beyond(assembly)[:5], [], program)


if __name__ == "__main__":
    PROGRAMS = sys.argv[1:]
    if not PROGRAMS:
        sys.exit(__doc__)
    unittest.main(argv=sys.argv[:1])
