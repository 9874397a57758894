"""How fast the panel is: python test/cases/panel/times.py (after sh test/run.sh --panel, which installs the browser)

First answer after the page is opened, a slider's redraw, and frames a second of the turning pair, each in the browser itself."""

import shutil
import statistics
import tempfile

from conftest import Front, Window
from playwright.sync_api import sync_playwright


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        front = Front(folder)
        browser = driver.chromium.launch(executable_path=shutil.which('chromium'), args=['--no-sandbox'])
        firsts = []
        for _ in range(5):
            window = Window(browser, front.address)
            firsts.append(window.page.evaluate("() => performance.getEntriesByName('answer')[0].startTime"))
            window.close()
        print(f'first answer after opening   {statistics.median(firsts):7.0f} ms, of 5 windows {min(firsts):.0f} to {max(firsts):.0f}')
        window = Window(browser, front.address)
        for group, key, values in (('relief', 'amount_um', range(8, 28)), ('dynamics', 'damping_ratio', (0.1 + 0.005 * i for i in range(20))), ('load', 'line_load_n_mm', range(250, 290, 2))):
            print(f'redraw, {key:20} {slide(window, group, key, list(values))}')
        before = int(window.page.get_attribute('#teeth', 'data-frames'))
        began = window.page.evaluate('() => performance.now()')
        window.page.wait_for_timeout(3000)
        frames = int(window.page.get_attribute('#teeth', 'data-frames')) - before
        print(f'frames a second              {1000 * frames / (window.page.evaluate("() => performance.now()") - began):7.1f}')
        browser.close()
        front.end()


def slide(window: Window, group: str, key: str, values: list) -> str:
    """Moves a slider from value to value, each after the answer to the last."""
    field = window.field(group, key)
    field.click()
    field.press('End')
    slider = window.page.locator(f'#field\\.{group}\\.{key} input[type=range]')
    window.page.evaluate("() => performance.clearMeasures('redraw')")
    for n, value in enumerate(values, 1):
        slider.evaluate("(one, value) => { one.value = value; one.dispatchEvent(new Event('input', { bubbles: true })); }", value)
        window.until(lambda n=n: window.page.evaluate("() => performance.getEntriesByName('redraw').length") >= n)
    found = sorted(window.page.evaluate("() => performance.getEntriesByName('redraw').map((one) => one.duration)"))
    slider.evaluate("(one) => one.dispatchEvent(new Event('change', { bubbles: true }))")
    window.up_to_date()
    return f'{statistics.median(found):7.0f} ms, of {len(found)} {found[0]:.0f} to {found[-1]:.0f}'


if __name__ == '__main__':
    main()
