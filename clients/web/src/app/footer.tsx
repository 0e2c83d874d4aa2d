/** What stands below the start page. */
export function Footer() {
  return (
    <footer class="footer">
      <a href="/openapi.json">API</a>
      <a href="/assets/licences.txt">Licences</a>
    </footer>
  );
}
