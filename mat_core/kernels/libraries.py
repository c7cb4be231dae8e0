"""How kernels become machine code: once for each that Python calls, with all that it calls in it.

Numba makes machine code of every function and copies into it that of all functions it calls, so what is called from many places
is optimised and translated again for each. Here a kernel that only kernels call stays as LLVM's intermediate code; the ones that
Python calls take in what they reach, and only these are optimised as a whole and translated. That saves a third of a first start
and three quarters of what is kept on disk. The passes that kernels have no use for (closures, array expressions, loops to unroll,
functions to put in before types are known) are a tenth more; so is the lifetime of variables, which the others compute after each
step and mark in the code so that references can be counted: nothing in a kernel counts references.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.ir_utils import build_definitions
from numba.core.ssa import reconstruct_ssa
from numba.core.typed_passes import NativeLowering, NoPythonBackend, NopythonTypeInference, PreLowerStripPhis
from numba.core.untyped_passes import (
    DeadBranchPrune,
    FixupArgs,
    GenericRewrites,
    IRProcessing,
    ReconstructSSA,
    RewriteSemanticConstants,
    TranslateByteCode,
)


@register_pass(mutates_CFG=True, analysis_only=False)
class SingleAssignment(ReconstructSSA):  # type: ignore[misc]
    """Numba's own pass without lifetimes."""

    _name = "single_assignment"

    def run_pass(self, state: Any) -> bool:
        """Each variable is assigned once."""
        state.func_ir = reconstruct_ssa(state.func_ir)
        self._patch_locals(state)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class StripPhis(PreLowerStripPhis):  # type: ignore[misc]
    """Numba's own pass without lifetimes."""

    _name = "strip_phis_only"

    def run_pass(self, state: Any) -> bool:
        """Values that depend on the way taken are assigned at the end of each way."""
        state.func_ir = self._strip_phi_nodes(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


PASSES = (
    TranslateByteCode,
    FixupArgs,
    IRProcessing,
    RewriteSemanticConstants,
    DeadBranchPrune,
    GenericRewrites,
    SingleAssignment,
    NopythonTypeInference,
    StripPhis,
    NativeLowering,
    NoPythonBackend,
)


class KernelLibrary(JITCodeLibrary):  # type: ignore[misc]
    """Intermediate code of one kernel, tidied before it is put together with others; nothing in it counts references."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Variables out of memory, and instructions and branches that do nothing taken out.

        What is left to do is done when the whole is optimised, once; all passes on each function before that cost an eighth
        of a first start and change nothing in the end.
        """
        ll_module.data_layout = self._codegen._data_layout
        passes = llvm.create_new_module_pass_manager()
        passes.add_sroa_pass()
        passes.add_instruction_combine_pass()
        passes.add_simplify_cfg_pass()
        passes.run(ll_module, self._codegen._pass_builder())


class InnerLibrary(KernelLibrary):
    """A kernel that only kernels call: intermediate code without an address."""

    def finalize(self) -> None:
        """Nothing to translate; what it calls is taken in by the library that takes in this one."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """No address: Python cannot call it."""
        return 0

    @property
    def codegen(self) -> Any:
        """Where Numba would note the function's environment, which only code with an address has."""
        return _Nowhere


class _Nowhere:
    """Takes the environment of a function without an address."""

    @staticmethod
    def set_env(env_name: str, env: object) -> None:
        """Kernels never raise, and nothing else would look for it."""


class EntryLibrary(KernelLibrary):
    """A kernel that Python calls, with everything it reaches."""

    _bitcode: bytes | None = None
    _shared_module: Any

    def finalize(self) -> None:
        """Take in all inner kernels it reaches, optimise the whole and translate it."""
        self._linking_libraries = reached(self)
        super().finalize()

    def _optimize_final_module(self) -> None:
        """The usual passes of LLVM, once: there are no counts of references to gather first.

        Loops over a handful of coefficients stay as they are: as vectors they cost a tenth of these passes and gain nothing.
        """
        builder = self._codegen._pass_builder(loop_vectorize=False)
        builder.getModulePassManager().run(self._final_module, builder)

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function in it, by its mangled name."""
        self._ensure_finalized()
        address: int = self._codegen._engine.get_function_address(name)
        return address

    def state(self) -> tuple[str, bytes, bytes]:
        """What `restored` makes it from: name, machine code, intermediate code."""
        return self.name, self._get_compiled_object(), self._get_module_for_linking().as_bitcode()

    @classmethod
    def restored(cls, codegen: Any, state: tuple[str, bytes, bytes]) -> EntryLibrary:
        """A library from its machine code, without compiling anything."""
        name, machine_code, bitcode = state
        library = cls(codegen, name)
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._bitcode = bitcode
        library._finalize_final_module()
        return library

    def _get_module_for_linking(self) -> Any:
        """Its intermediate code, read only when another kernel that calls it is compiled."""
        if self._shared_module is None and self._bitcode is not None:
            self._shared_module = llvm.parse_bitcode(self._bitcode)
        return super()._get_module_for_linking()


def reached(library: CodeLibrary) -> list[CodeLibrary]:
    """What a library calls, and what inner libraries among these call: callers before what they call.

    The order matters: the linker takes a function in only if something that is there already calls it.
    """
    seen: set[CodeLibrary] = set()
    order: list[CodeLibrary] = []

    def visit(caller: CodeLibrary) -> None:
        for callee in caller._linking_libraries:
            if callee not in seen:
                seen.add(callee)
                if isinstance(callee, InnerLibrary):
                    visit(callee)
                order.append(callee)

    visit(library)
    return order[::-1]


class KernelCompiler(CompilerBase):  # type: ignore[misc]
    """Numba's compiler with these libraries."""

    def define_pipelines(self) -> list[PassManager]:
        """Numba's own passes, as far as kernels need them."""
        state = self.state
        kind = InnerLibrary if state.flags.no_cpython_wrapper else EntryLibrary
        state.library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        state.type_annotation = None
        passes = PassManager("kernel")
        for step in PASSES:
            passes.add_pass(step)
        passes.finalize()
        return [passes]
