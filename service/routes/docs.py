"""The documentation page, served whole from this package: it works without the internet."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.staticfiles import StaticFiles

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


@router.get("/")
async def root() -> Response:
    """Someone who opens the bare address in a browser wants the documentation."""
    return Response(status_code=307, headers={"Location": "docs"})
