"""A browser without a window, for the tests of panel and site."""

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
