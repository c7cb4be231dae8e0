"""The documentation page, served whole from this package: it works without the internet."""

from __future__ import annotations

from pathlib import Path

import orjson
from fastapi import APIRouter, Request, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.staticfiles import StaticFiles

from service.http.responses import document_response

STATIC = Path(__file__).resolve().parents[1] / "static"

router = APIRouter(include_in_schema=False)
files = StaticFiles(directory=STATIC)


@router.get("/docs")
async def docs() -> Response:
    """The OpenAPI document as a page to read and try."""
    return get_swagger_ui_html(
        openapi_url="openapi.json",
        title="Medial axis transform",
        swagger_js_url="static/swagger-ui-bundle.js",
        swagger_css_url="static/swagger-ui.css",
        swagger_favicon_url="static/favicon.png",
        swagger_ui_parameters={"validatorUrl": None, "tryItOutEnabled": True, "defaultModelsExpandDepth": 0},
    )


@router.get("/openapi.json")
async def openapi(request: Request) -> Response:
    """The OpenAPI document; made and written once, on first use."""
    state = request.app.state
    if not hasattr(state, "openapi_text"):
        state.openapi_text = orjson.dumps(request.app.openapi())
    return document_response(request, state.openapi_text, "application/json")
