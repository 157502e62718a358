/** The service worker of a site, for element.test.js. */
import "/src/service_worker.js";
