"""OGC API - Processes, part 1: the landing page, conformance, descriptions, and execution by the same code as below /v1."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.routing import APIRoute

from service import processes
from service.http.negotiation import FORMATS, choose_format
from service.http.responses import document_response
from service.operations import OPERATIONS
from service.routes import jobs
from service.routes.solve import answer, make_order

router = APIRouter(tags=["OGC API - Processes"])

ProcessId = Annotated[str, Path(description="the name of a process", json_schema_extra={"enum": list(OPERATIONS)})]


@router.get("/", response_model=processes.LandingPage)
async def landing_page(request: Request) -> Response:
    """What there is, as links; someone with a browser is led to the documentation."""
    accept = request.headers.get("accept", "*/*")
    if "text/html" in accept.lower():
        return Response(status_code=307, headers={"Location": "docs", "Vary": "Accept"})
    app = request.app
    page = processes.landing_page(request.scope.get("root_path", ""), app.title, app.openapi()["info"]["summary"])
    return _document(request, processes.text(page))


@router.get("/conformance", response_model=processes.Conformance)
async def conformance(request: Request) -> Response:
    """The classes of the standard that are fulfilled."""
    return _document(request, processes.text(processes.Conformance(conformsTo=processes.CONFORMS_TO)))


@router.get("/processes", response_model=processes.ProcessList)
async def process_list(
    request: Request,
    limit: Annotated[int, Query(ge=1, le=1000, description="most processes listed")] = 100,
    offset: Annotated[int, Query(ge=0, le=10_000, description="how many are left out at the beginning")] = 0,
) -> Response:
    """The processes: one for each route below /v1."""
    return _document(request, processes.text(processes.process_list(request.scope.get("root_path", ""), limit, offset)))


@router.get("/processes/{process_id}", response_model=processes.Process)
async def process(request: Request, process_id: ProcessId) -> Response:
    """The inputs and outputs of a process, with their schemas."""
    described = processes.process(request.scope.get("root_path", ""), processes.operation(process_id))
    return _document(request, processes.text(described))


@router.post("/processes/{process_id}/execution", operation_id="execute")
async def execute(request: Request, process_id: ProcessId) -> Response:
    """Run a process: the inputs in, its output back, or a document with it."""
    operation = processes.operation(process_id)
    media_types = {FORMATS[form]: form for form in operation.formats}
    return await answer(request, make_order(request, operation, None, None, execute=media_types))


for _route in jobs.router.routes:  # the same jobs at the addresses that the standard has for them
    assert isinstance(_route, APIRoute)
    router.add_api_route(
        _route.path.removeprefix("/v1"),
        _route.endpoint,
        methods=list(_route.methods or ()),
        response_model=_route.response_model,
        response_model_exclude_none=True,
        include_in_schema=False,
    )


def _document(request: Request, content: bytes) -> Response:
    """A document of this family: JSON only."""
    choose_format(None, request.headers.get("accept", "*/*"), ("json",))
    return document_response(request, content, FORMATS["json"], vary="Accept, Accept-Encoding")
