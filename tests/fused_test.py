"""That the compiler fused no multiplications and additions on its own, as g++ 12 does in spite of -ffp-contract=off (gcc bug 107647):
`fused_test.py LIBRARY`. Its mark are vfmaddsub and vfmsubadd, which nobody here asks for; what Eigen asks for is of other names."""
import re
import subprocess
import sys

FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
FUSED = re.compile(r"\tv?fm(addsub|subadd)\w*\b")


def fused(lines):
    """Functions that hold such an instruction, with the first of them."""
    found, function = {}, "?"
    for line in lines:
        if begins := FUNCTION.match(line):
            function = begins[1]
        elif FUSED.search(line):
            found.setdefault(function, line.strip())
    return found


def main():
    sample = ["0000000000001000 <kabsch>:", "  1008:\tvmulpd %xmm1,%xmm2,%xmm3", "  100c:\tvfmsubadd132pd %xmm6,%xmm0,%xmm2"]
    assert list(fused(sample)) == ["kabsch"] and not fused(sample[:2])
    dump = subprocess.Popen(["objdump", "-d", "-C", "--no-show-raw-insn", sys.argv[1]], stdout=subprocess.PIPE, text=True)
    found = fused(dump.stdout)
    if dump.wait() != 0:
        sys.exit(f"{sys.argv[1]}: objdump cannot read it")
    for function, line in found.items():
        print(f"{function}: {line}: write the sums so that none is beside a difference of products in one loop")
    sys.exit(1 if found else 0)


main()
