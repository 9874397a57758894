"""A page of the site in a browser without a network."""

import pytest


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
