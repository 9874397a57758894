"""A browser without a window or a network."""

import shutil

import pytest
from playwright.sync_api import sync_playwright


@pytest.fixture(scope='session')
def browser():
    path = shutil.which('chromium')
    if path is None:
        pytest.fail('there is no chromium; sh test/run.sh --panel installs it')
    with sync_playwright() as driver:
        one = driver.chromium.launch(executable_path=path, args=['--no-sandbox'])
        yield one
        one.close()


@pytest.fixture
def page(browser):
    """A page that must find all it needs in the folder of the site."""
    context = browser.new_context(viewport={'width': 1280, 'height': 900}, offline=True)
    context.set_default_timeout(60000)
    page = context.new_page()
    page.asked = []
    page.on('request', lambda request: page.asked.append(request.url))
    yield page
    assert not [url for url in page.asked if not url.startswith(('file:', 'blob:', 'data:'))]
    context.close()
