# SPDX-License-Identifier: GPL-3.0-or-later
"""What the interface says in other languages: labels, names and tooltips here, messages in `german_messages`.

A language is a dictionary from the English text. Blender takes what it finds here, and English for the rest; a test
holds every language to be complete.
"""

from __future__ import annotations

import inspect

import bpy

from .german_messages import MESSAGES as GERMAN_MESSAGES

GERMAN = {
    # Operators and the sidebar
    "Annotations to Mesh": "Anmerkungen zu Mesh",
    "Fill All Holes": "Alle Löcher füllen",
    "Fill the selected hole with a regular patch of triangles or quads that fits its edges": (
        "Das ausgewählte Loch mit einem regelmäßigen Flicken aus Dreiecken oder Vierecken füllen, der an seine Kanten "
        "passt"
    ),
    "Keep Shape": "Form behalten",
    "Lay the grid on the old surface; without, the area becomes a smooth patch between its edges": (
        "Das Gitter auf die alte Oberfläche legen; ohne dies wird das Gebiet ein glatter Flicken zwischen seinen Kanten"
    ),
    "Mesh the selected faces, or the area inside a selected loop, anew with a regular grid on the same surface": (
        "Die ausgewählten Flächen oder das Gebiet in einer ausgewählten Schleife mit einem regelmäßigen Gitter auf derselben "
        "Oberfläche neu vernetzen"
    ),
    "Regrid": "Neu mit Gitter",
    "Grid Patch Fill": "Loch mit Gitter füllen",
    "Make a smooth body with a clean mesh of triangles or quads from each closed stroke": (
        "Aus jedem geschlossenen Strich einen glatten Körper mit sauberem Netz aus Dreiecken oder Vierecken machen"
    ),
    "Enough Triangles": "Genug Dreiecke",
    "Give the selected live bodies as many triangles as put five across their thinnest limbs": (
        "Den ausgewählten Körpern so viele Dreiecke geben, dass fünf quer über ihre dünnsten Glieder gehen"
    ),
    # Pictures
    "Bones for a Vertex": "Knochen je Punkt",
    "How far a joint reaches into the limbs that meet there, relative to half their width": (
        "Wie weit ein Gelenk in die Glieder reicht, die sich dort treffen, im Verhältnis zu ihrer halben Breite"
    ),
    "Joint Reach": "Reichweite der Gelenke",
    "Let the selected flat meshes follow the bones of the active armature, each bone within its own limb": (
        "Die ausgewählten flachen Meshes den Knochen der aktiven Armature folgen lassen, jeder Knochen in seinem Glied"
    ),
    "The most bones that move a vertex": "Wie viele Knochen einen Punkt höchstens bewegen",
    "Weights from Bones": "Gewichte von Knochen",
    "Background": "Hintergrund",
    "Give a Threshold": "Schwelle angeben",
    "Give the threshold, instead of the one that parts the pixels best on paper, and elsewhere 0.5, or less for glows and shadows of flat sheets": (
        "Die Schwelle angeben, statt auf Papier der, die die Pixel am besten trennt, und sonst 0,5, oder weniger bei Schein und Schatten flacher Meshes"
    ),
    "Hide Picture": "Bild verbergen",
    "See it in Material Preview": "In der Materialvorschau zu sehen",
    "Hide the object that shows the picture, which is in the same place": (
        "Das Objekt verbergen, das das Bild zeigt und an derselben Stelle ist"
    ),
    "How far a pixel must be covered to lie inside the outline": (
        "Wie weit ein Pixel bedeckt sein muss, um im Umriss zu liegen"
    ),
    "How far along the outline is looked to remove what pixels put in; 0 keeps it as it is": (
        "Wie weit am Umriss entlang geschaut wird, um zu entfernen, was von den Pixeln kommt; 0 lässt ihn, wie er ist"
    ),
    "How far the outline is moved outward, in pixels; the margin of a body is opaque": (
        "Wie weit der Umriss nach außen rückt, in Pixeln; der Rand eines Körpers ist undurchsichtig"
    ),
    "How far the outline is moved outward, in pixels; from 1 on the mesh covers pixels whole, but for the finest tips": (
        "Wie weit der Umriss nach außen rückt, in Pixeln; ab 1 bedeckt das Mesh ganze Pixel, bis auf die feinsten Spitzen"
    ),
    "Islands and holes of fewer pixels are left out; set it higher for specks on paper": "Inseln und Löcher mit weniger Pixeln werden weggelassen; für Flecken auf Papier höher stellen",
    "Least Area": "Kleinste Fläche",
    "Leave holes open; without, closed lines are filled": (
        "Löcher offen lassen; ohne dies werden geschlossene Linien gefüllt"
    ),
    "Let lights and shadows fall on the picture; without, it shines in its own colors": (
        "Licht und Schatten auf das Bild fallen lassen; ohne dies leuchtet es in eigenen Farben"
    ),
    "Lit": "Beleuchtet",
    "Make a sprite or a body of what each picture shows, with the picture on it": (
        "Aus dem, was jedes Bild zeigt, ein Sprite oder einen Körper machen, mit dem Bild darauf"
    ),
    "Margin": "Rand",
    "Number of triangles of one side of all that the picture shows; thin parts get more": (
        "Anzahl der Dreiecke einer Seite von allem, was das Bild zeigt; dünne Teile bekommen mehr"
    ),
    "Paper": "Papier",
    "Picture to Mesh": "Bild zu Mesh",
    "Read the pictures of the selected sprites and bodies again, and make their meshes anew": (
        "Die Bilder der ausgewählten Sprites und Körper neu lesen und ihre Meshes neu machen"
    ),
    "Smoothing": "Glättung",
    "The paper of a scan or photograph, also under uneven light; a dark board around what is bright": (
        "Das Papier eines Scans oder Fotos, auch unter ungleichmäßigem Licht; eine dunkle Tafel um das, was hell ist"
    ),
    "Threshold": "Schwelle",
    "Transparent": "Durchsichtig",
    "Update from Picture": "Aus dem Bild aktualisieren",
    "What is transparent": "Was durchsichtig ist",
    "What is transparent; paper where nothing is": "Was durchsichtig ist; Papier, wo nichts es ist",
    "What of the picture is left out": "Was vom Bild weggelassen wird",
    "Presets": "Vorgaben",
    "Select a drawing or a curve": "Zeichnung oder Kurve auswählen",
    "Strokes to Mesh": "Striche zu Mesh",
    "Update Bodies": "Körper aktualisieren",
    # Presets
    "Body Flat Badge": "Körper: flache Plakette",
    "Body Limbs and Tubes": "Körper: Glieder und Röhren",
    "Body Round": "Körper: rund",
    "Sprite Deformation Heavy": "Sprite: starke Verformung",
    "Sprite Deformation Little": "Sprite: leichte Verformung",
    "Sprite Mirrored Face": "Sprite: gespiegeltes Gesicht",
    "Body Round Quads": "Körper: rund, Vierecke",
    "Sprite Quads": "Sprite: Vierecke",
    "Sprite Standard": "Sprite: Standard",
    # Where the strokes are, and which
    "Active": "Aktiv",
    "Active collection": "Die aktive Sammlung",
    "All": "Alle",
    "All strokes; those that cannot be closed are named": (
        "Alle Striche; solche, die sich nicht schließen lassen, werden genannt"
    ),
    "Annotations": "Anmerkungen",
    "Annotations of the scene, drawn in space": "Anmerkungen der Szene, die im Raum gezeichnet sind",
    "Close Gaps": "Lücken schließen",
    "Closed": "Geschlossene",
    "Collection": "Sammlung",
    "Collection that new objects go to": "Sammlung, in die neue Objekte kommen",
    "Collection that the strokes are in": "Die Sammlung, in der die Striche sind",
    "Grease pencil, curve and text objects that are selected or being edited": (
        "Grease-Pencil-, Kurven- und Textobjekte, die ausgewählt sind oder bearbeitet werden"
    ),
    "Holes": "Löcher",
    "Largest gap that is closed, and longest overshoot cut off, relative to the stroke": (
        "Größte Lücke, die geschlossen, und längster Überstand, der abgeschnitten wird, im Verhältnis zum Strich"
    ),
    "Make strokes inside others of the same layer holes in them, and strokes inside holes bodies": (
        "Striche in anderen derselben Ebene zu deren Löchern machen, und Striche in Löchern zu Körpern"
    ),
    "New": "Neu",
    "New collection beside the strokes": "Eine neue Sammlung neben den Strichen",
    "Objects": "Objekte",
    "Of the Source": "Der Quelle",
    "Replace the mesh of the object made from the stroke before, and keep all else of it": (
        "Nur das Mesh des Objekts ersetzen, das früher aus dem Strich gemacht wurde"
    ),
    "Resolve Crossings": "Kreuzungen auflösen",
    "Selected": "Ausgewählte",
    "Source": "Quelle",
    "Strokes": "Striche",
    "Strokes that are closed or nearly so; leave out open ones": (
        "Striche, die geschlossen sind oder beinahe; offene weglassen"
    ),
    "Strokes that are selected, or have a selected point": (
        "Striche, die ausgewählt sind oder einen ausgewählten Punkt haben"
    ),
    "Strokes that become meshes": "Striche, aus denen Meshes werden",
    "Take the outer outline of strokes that cross themselves, instead of refusing them": (
        "Bei Strichen, die sich selbst kreuzen, den äußeren Umriss nehmen, statt sie abzulehnen"
    ),
    "Update Existing": "Vorhandene aktualisieren",
    "Use": "Verwenden",
    "Where the strokes are": "Wo die Striche sind",
    # The grid
    "Angle": "Winkel",
    "Angle of the grid in the drawing plane, from 0 to 60 degrees, of quads to 90": (
        "Winkel des Gitters in der Zeichenebene, von 0 bis 60 Grad, bei Vierecken bis 90"
    ),
    "Automatic": "Automatisch",
    "Boundary": "Rand",
    "Corner Angle": "Eckenwinkel",
    "Direction of the grid; a fixed one does not bend with the drawing": (
        "Richtung des Gitters; eins mit einer festen biegt sich nicht mit der Zeichnung"
    ),
    "Faces": "Flächen",
    "What the mesh is made of": "Woraus das Netz besteht",
    "Triangles, six around almost every vertex": "Dreiecke, sechs um fast jeden Punkt",
    "Quads": "Vierecke",
    "Quads, four around almost every vertex, in edge loops along the outline; for subdivision and rigging": (
        "Vierecke, vier um fast jeden Punkt, in Kantenschleifen am Umriss entlang; zum Unterteilen und Riggen"
    ),
    "Number": "Anzahl",
    "Quads of Each Side": "Vierecke jeder Seite",
    "Number of quads of one side, reached within 10%; a body has two sides": (
        "Zahl der Vierecke einer Seite, auf 10% genau; ein Körper hat zwei Seiten"
    ),
    "Number of quads of one side of all that the picture shows; thin parts get more": (
        "Anzahl der Vierecke einer Seite von allem, was das Bild zeigt; dünne Teile bekommen mehr"
    ),
    "Edge Length": "Kantenlänge",
    "Find the axis of a drawing that is symmetric within 2% of its size, and mesh both halves alike": (
        "Die Achse einer Zeichnung finden, die bis auf 2% ihrer Größe symmetrisch ist, und beide Hälften gleich vernetzen"
    ),
    "Find the rim with the fewest turns near the stroke, for the fewest irregular vertices": (
        "Den Rand mit den wenigsten Wendungen nahe am Strich suchen, für die wenigsten unregelmäßigen Punkte"
    ),
    "Fixed": "Fest",
    "Give the angle": "Den Winkel angeben",
    "Give the length of the edges": "Die Länge der Kanten angeben",
    "Give the number of triangles or quads of each side": (
        "Die Zahl der Dreiecke oder Vierecke jeder Seite angeben"
    ),
    "Grid": "Gitter",
    "Grid Angle": "Gitterwinkel",
    "Grow the grid from the middle and straighten its rim; for triangles": (
        "Das Gitter von der Mitte aus wachsen lassen und seinen Rand begradigen; für Dreiecke"
    ),
    "Grown": "Gewachsen",
    "How far the grid's rim may stray before it is moved onto the stroke, in edge lengths": (
        "Wie weit der Rand des Gitters abweichen darf, bevor er auf den Strich gerückt wird, in Kantenlängen"
    ),
    "Bend": "Biegung",
    "Detail in Thin Parts": "Feinheit dünner Teile",
    "How much smaller faces are in thin parts than elsewhere, on a grid that bends; at 0 they are about as large": (
        "Wie viel kleiner die Flächen in dünnen Teilen sind als anderswo, auf einem Gitter, das sich biegt; bei 0 sind sie etwa gleich groß"
    ),
    "Detail by Pen Width": "Feinheit nach Strichbreite",
    "How much the width of the drawn line drives how many faces there are, on a grid that bends": (
        "Wie sehr die Breite der gezeichneten Linie bestimmt, wie viele Flächen es gibt, auf einem Gitter, das sich biegt"
    ),
    "How far a grid of triangles may bend with the stroke, which leaves fewer irregular vertices; 0 is straight": (
        "Wie weit sich ein Gitter aus Dreiecken mit dem Strich biegen darf; so bleiben weniger unregelmäßige Punkte; 0 ist gerade"
    ),
    "How the fineness of the mesh is given": "Wie die Feinheit des Netzes angegeben wird",
    "How the rim of the grid is chosen": "Wie der Rand des Gitters gewählt wird",
    "Keep corners where the stroke turns by more than this angle": (
        "Ecken erhalten, an denen der Strich um mehr als diesen Winkel abbiegt"
    ),
    "Length of the edges of the mesh, seeded from the strokes": (
        "Länge der Kanten des Netzes, vorgeschlagen nach den Strichen"
    ),
    "Max Distance": "Größter Abstand",
    "Mesh the drawing as it is": "Die Zeichnung vernetzen, wie sie ist",
    "Mirror": "Spiegeln",
    "As many faces as put five across the thinnest limb: 1000 to 20000 triangles of each side, or half as many quads": (
        "So viele Flächen, dass fünf quer über das dünnste Glied gehen: 1000 bis 20000 Dreiecke jeder Seite, oder halb so "
        "viele Vierecke"
    ),
    "Number of triangles of one side, reached within 10%; a body has two sides": (
        "Zahl der Dreiecke einer Seite, auf 10% genau; ein Körper hat zwei Seiten"
    ),
    "Off": "Aus",
    "Optimal": "Optimal",
    "Resolution": "Auflösung",
    "Take the best of several angles": "Den besten von mehreren Winkeln nehmen",
    "Triangles": "Dreiecke",
    "Triangles of Each Side": "Dreiecke jeder Seite",
    "Whether the mesh of a symmetric drawing is its own mirror image": (
        "Ob das Netz einer symmetrischen Zeichnung sein eigenes Spiegelbild ist"
    ),
    # The shape
    "A flat mesh in the drawing plane": "Ein flaches Mesh in der Zeichenebene",
    "A smooth closed body, inflated to both sides of the drawing plane": (
        "Ein glatter geschlossener Körper, nach beiden Seiten der Zeichenebene aufgeblasen"
    ),
    "Back": "Rückseite",
    "Beside the front: each side can be painted by itself": (
        "Neben der Vorderseite: jede Seite lässt sich für sich bemalen"
    ),
    "Fit for Subdivision": "Für Unterteilung passend",
    "Lay the rim of quads so far outside that it lies on the drawing when a Subdivision Surface modifier smooths the body": (
        "Den Rand von Vierecken so weit nach außen legen, dass er auf der Zeichnung liegt, wenn ein Subdivision-Surface-Modifikator "
        "den Körper glättet"
    ),
    "On Top of Each Other": "Aufeinander",
    "Side by Side": "Nebeneinander",
    "UV Layout": "UV-Anordnung",
    "Where the back of a body lies in the UV map": "Wo die Rückseite eines Körpers in der UV-Karte liegt",
    "Where the front is: what is painted on one side is on both": (
        "Auf der Vorderseite: was auf eine Seite gemalt wird, ist auf beiden"
    ),
    "Body": "Körper",
    "Cross-section of the body": "Querschnitt des Körpers",
    "Depth": "Tiefe",
    "Depth of the side that faces down or to the back": "Tiefe der Seite, die nach unten oder hinten zeigt",
    "Depth of the side that faces up or to the front": "Tiefe der Seite, die nach oben oder vorn zeigt",
    "Even": "Gleichmäßig",
    "Flat": "Flach",
    "Flat Sheet": "Flaches Blatt",
    "Flat with a rounded rim": "Flach mit gerundetem Rand",
    "Front": "Vorderseite",
    "Give the depth of the front and the back separately": (
        "Die Tiefe von Vorder- und Rückseite getrennt angeben"
    ),
    "Peak": "Spitz",
    "Profile": "Profil",
    "Rising evenly to a ridge": "Gleichmäßig ansteigend zu einem Grat",
    "Round": "Rund",
    "Round; a circle becomes a sphere": "Rund; aus einem Kreis wird eine Kugel",
    "Round; a long limb becomes a round tube": "Rund; aus einem langen Glied wird eine runde Röhre",
    "Separate Sides": "Getrennte Seiten",
    "Shape": "Form",
    "Thickness of the body; at 1 a circle becomes a sphere": (
        "Dicke des Körpers; bei 1 wird aus einem Kreis eine Kugel"
    ),
    "What is made of a stroke": "Was aus einem Strich wird",
    # Bodies that follow their drawing
    "Adopt": "Übernehmen",
    "Drawing": "Zeichnung",
    "Follow": "Folgen",
    "Follow the Stroke": "Dem Strich folgen",
    "Freeze": "Einfrieren",
    "How much the width of the drawn line drives the depth of the body there": (
        "Wie sehr die Breite der gezeichneten Linie dort die Tiefe des Körpers bestimmt"
    ),
    "Let the body follow its stroke": "Den Körper seinem Strich folgen lassen",
    "Let the body follow when its stroke is edited; the switch is in the sidebar": (
        "Den Körper folgen lassen, wenn sein Strich bearbeitet wird; der Schalter ist in der Seitenleiste"
    ),
    "Live Body": "Lebender Körper",
    "Make the bodies of the selected drawings, or the selected bodies, anew with these options; each stays the same "
    "object. Strokes without a body get one": (
        "Die Körper der ausgewählten Zeichnungen, oder die ausgewählten Körper, mit diesen Optionen neu machen; jeder "
        "bleibt dasselbe Objekt. Striche ohne Körper bekommen einen"
    ),
    "Make the selected bodies anew from their outlines; what was changed in their meshes by hand is lost": (
        "Die ausgewählten Körper neu aus ihren Umrissen machen; was von Hand an ihren Meshes geändert wurde, geht verloren"
    ),
    "Rebuild from Outline": "Neu aus dem Umriss",
    "Make plain meshes of the selected bodies; outlines drawn with the tool are removed": (
        "Aus den ausgewählten Körpern gewöhnliche Meshes machen; mit dem Werkzeug gezeichnete Umrisse werden entfernt"
    ),
    "Make the selected bodies anew with this version of GridMesh, and let them follow their drawing": (
        "Die ausgewählten Körper mit dieser Version von GridMesh neu machen und ihrer Zeichnung folgen lassen"
    ),
    "Pen Width": "Strichbreite",
    # The quality of a mesh
    "Count irregular vertices of the selected meshes and find the sharpest angle": (
        "Unregelmäßige Punkte der ausgewählten Meshes zählen und den spitzesten Winkel suchen"
    ),
    "Mesh Quality": "Netzqualität",
    "Show irregular vertices of the selected meshes by their number of edges, and the numbers": (
        "Unregelmäßige Punkte der ausgewählten Meshes nach der Zahl ihrer Kanten zeigen, und die Zahlen"
    ),
    # Drawing bodies
    "Across the X axis, through the 3D cursor": "Quer zur X-Achse, durch den 3D-Cursor",
    "Across the Y axis, through the 3D cursor": "Quer zur Y-Achse, durch den 3D-Cursor",
    "Across the Z axis, through the 3D cursor": "Quer zur Z-Achse, durch den 3D-Cursor",
    "Cursor": "Cursor",
    "Facing the view, through the 3D cursor": "Der Ansicht zugewandt, durch den 3D-Cursor",
    "GridMesh Draw": "GridMesh zeichnen",
    "GridMesh Cut": "GridMesh schneiden",
    "Cut the selected meshes.\nDrag across them, then click the side to keep; Enter keeps both": (
        "Die ausgewählten Meshes zerschneiden.\nQuer darüber ziehen, dann die Seite anklicken, die bleibt; Eingabe behält beide"
    ),
    "How much the pressure of the pen drives the depth of the body": (
        "Wie sehr der Druck des Stifts die Tiefe des Körpers bestimmt"
    ),
    "Plane": "Ebene",
    "Plane of the 3D cursor's X and Y": "Ebene von X und Y des 3D-Cursors",
    "Surface": "Fläche",
    "Tangent to the surface where the stroke begins; facing the view beside surfaces": (
        "Tangential zur Fläche, wo der Strich beginnt; neben Flächen der Ansicht zugewandt"
    ),
    "View": "Ansicht",
    "X Axis": "X-Achse",
    "Y Axis": "Y-Achse",
    "Z Axis": "Z-Achse",
    # What a stroke does
    "A stroke of its own over a body, which it is joined to": (
        "Ein eigener Strich über einem Körper, mit dem er zusammengeführt wird"
    ),
    "A stroke over a body becomes a part of it, a stroke of its own that the body is joined with": (
        "Ein Strich über einem Körper wird ein Teil von ihm, ein eigener Strich, mit dem der Körper zusammengeführt wird"
    ),
    "Behind": ("Dahinter"),
    "D: Part Lies": ("D: Lage des Teils"),
    "Give a part a mirror image, across the X axis of the body, that follows the same stroke": (
        "Einem Teil ein Spiegelbild geben, über die X-Achse des Körpers, das demselben Strich folgt"
    ),
    "In Front": ("Davor"),
    "In front where the stroke lies inside the body, else in the middle": (
        "Davor, wo der Strich innerhalb des Körpers liegt, sonst in der Mitte"
    ),
    "Join Part": ("Teil zusammenführen"),
    "Make one closed body of the part and what it is drawn over; without, it is a body of its own and a child of that": (
        "Aus dem Teil und dem, worüber er gezeichnet ist, einen geschlossenen Körper machen; ohne dies ist er ein eigener Körper "
        "und dessen Kind"
    ),
    "Middle": ("Mitte"),
    "Part Lies": ("Lage des Teils"),
    "T: Twin": ("T: Zwilling"),
    "The middle of the part is on the far side of the body": (
        "Die Mitte des Teils ist auf der abgewandten Seite des Körpers"
    ),
    "The middle of the part is on the side of the body that is seen": (
        "Die Mitte des Teils ist auf der Seite des Körpers, die man sieht"
    ),
    "The part goes through the middle of the body": "Der Teil geht durch die Mitte des Körpers",
    "Twin": ("Zwilling"),
    "Where a part lies, seen from the view; its depth can be changed later in the sidebar": (
        "Wo ein Teil liegt, von der Ansicht aus gesehen; seine Tiefe lässt sich später in der Seitenleiste ändern"
    ),
    "A new body, whatever the stroke meets": ("Ein neuer Körper, was immer der Strich berührt"),
    "Action": ("Aktion"),
    "Add Part": ("Teil hinzufügen"),
    "Add the stroke to a body": ("Den Strich zu einem Körper hinzufügen"),
    "Add to the body that the stroke meets; others that it reaches in the same plane join in": (
        "Zu dem Körper hinzufügen, den der Strich berührt; andere, die er in derselben Ebene erreicht, werden mit ihm eins"
    ),
    "As the stroke lies: across an outline it extends the body, elsewhere it is a new one": (
        "Wie der Strich liegt: über einen Umriss hinweg erweitert er den Körper, sonst wird er ein neuer"
    ),
    "Draw Body": ("Körper zeichnen"),
    "Draw an outline, get a body.\nAcross the outline of a body it extends that; Shift takes away. A click selects": (
        "Einen Umriss zeichnen, und es wird ein Körper daraus.\nÜber den Umriss eines Körpers hinweg erweitert er diesen; Umschalt nimmt weg. Ein Klick wählt aus"
    ),
    "Draw the mirror image too, across an upright line through the active live body or the 3D cursor": (
        "Auch das Spiegelbild zeichnen, an einer senkrechten Linie durch den aktiven lebenden Körper oder den 3D-Cursor"
    ),
    "Draw the outline of a body, or across the outline of one to extend it; Shift takes away": (
        "Den Umriss eines Körpers zeichnen, oder über den eines anderen hinweg, um ihn zu erweitern; Umschalt nimmt weg"
    ),
    "Draw, Click: Select": ("Zeichnen, Klick: Auswählen"),
    "Esc, Right Click: Leave": ("Esc, Rechtsklick: Verwerfen"),
    "Extend": ("Erweitern"),
    "Extend Body": ("Körper erweitern"),
    "Factor": ("Faktor"),
    "Hole": ("Loch"),
    "Hole in": ("Loch in"),
    "How far the outline may move, in parts of its size": (
        "Wie weit der Umriss sich verschieben darf, in Teilen seiner Größe"
    ),
    "How far the stroke stays behind, in pixels": ("Wie weit der Strich zurückbleibt, in Pixeln"),
    "How slowly the stroke follows": ("Wie langsam der Strich folgt"),
    "Leave fewer points of the outlines of the selected live bodies, so that they are easier to edit": (
        "Von den Umrissen der ausgewählten lebenden Körper weniger Punkte übrig lassen, damit sie leichter zu bearbeiten sind"
    ),
    "Let the stroke follow the mouse at a distance, which smooths it": (
        "Den Strich der Maus in einem Abstand folgen lassen, was ihn glättet"
    ),
    "Make Hole": ("Loch machen"),
    "Make a body of the stroke that belongs to another one": (
        "Aus dem Strich einen Körper machen, der zu einem anderen gehört"
    ),
    "Make a hole in a body": ("Ein Loch in einen Körper machen"),
    "Make a hole in the body that the stroke lies in": (
        "Ein Loch in den Körper machen, in dem der Strich liegt"
    ),
    "Make a new body of the stroke": ("Aus dem Strich einen neuen Körper machen"),
    "Mirror Stroke": ("Strich spiegeln"),
    "New Bodies": ("Neue Körper"),
    "New Body": ("Neuer Körper"),
    "Nothing": ("Nichts"),
    "P: Part": ("P: Teil"),
    "Part": ("Teil"),
    "Part of": ("Teil von"),
    "Radius": ("Radius"),
    "Shift, Ctrl: Take Away": ("Umschalt, Strg: Wegnehmen"),
    "Simplify Outline": ("Umriss vereinfachen"),
    "Stabilize Stroke": ("Strich stabilisieren"),
    "Take Away": ("Wegnehmen"),
    "Take away from the body that the stroke meets": ("Von dem Körper wegnehmen, den der Strich berührt"),
    "Take the stroke away from a body": ("Den Strich von einem Körper wegnehmen"),
    "Tolerance": ("Toleranz"),
    "Trim": ("Beschneiden"),
    "Trim Body": ("Körper beschneiden"),
    "What the stroke does": ("Was der Strich tut"),
    "Where the stroke lies; facing the view, it takes the plane of the body that it meets": (
        "Wo der Strich liegt; der Ansicht zugewandt nimmt er die Ebene des Körpers, den er berührt"
    ),
    "X: Mirror": ("X: Spiegeln"),
    # The curve of the profile
    "A dome with a brim": "Eine Kuppel mit Krempe",
    "A straight line, which leaves the profile as it is": "Eine Gerade, die das Profil lässt, wie es ist",
    "Active Body": "Aktiver Körper",
    "Add Profile Curve": "Profilkurve hinzufügen",
    "As It Is": "Wie es ist",
    "As the curve of the active live body; none if that has none": (
        "Wie die Kurve des aktiven lebenden Körpers; keine, wenn der keine hat"
    ),
    "Curve": "Kurve",
    "Curve that reshapes the profile; that of a live body is edited in its panel in the sidebar": (
        "Kurve, die das Profil umformt; die eines lebenden Körpers wird in dessen Leiste an der Seite bearbeitet"
    ),
    "Curve to start from": "Kurve, mit der begonnen wird",
    "Edit the curve in the sidebar, Live Body": "Die Kurve bearbeiten: Seitenleiste, Lebender Körper",
    "Follow the Stroke, to edit the curve": "Dem Strich folgen, um die Kurve zu bearbeiten",
    "Flat at the rim, with a point in the middle": "Flach am Rand, mit einer Spitze in der Mitte",
    "Give the selected bodies a curve that reshapes their profile, from rim to top; edit it below": (
        "Den ausgewählten Körpern eine Kurve geben, die ihr Profil vom Rand bis oben umformt; sie wird darunter bearbeitet"
    ),
    "Hat": "Hut",
    "Highest around a hollow in the middle": "Am höchsten um eine Mulde in der Mitte",
    "None": "Keine",
    "Plateau": "Plateau",
    "Pointed": "Spitz",
    "Profile Curve": "Profilkurve",
    "Ring": "Ring",
    "Steep at the rim, level on top": "Steil am Rand, oben eben",
    "Take the curve away": "Die Kurve wegnehmen",
    "The profile as it is; a live body that is updated keeps the curve it has": (
        "Das Profil, wie es ist; ein lebender Körper, der aktualisiert wird, behält seine Kurve"
    ),
    # Cutting
    "Along a line drawn in the viewport": "Entlang einer Linie, die im Fenster gezeichnet wird",
    "Along a stroke of a selected grease pencil or curve object": (
        "Entlang eines Strichs eines ausgewählten Grease-Pencil- oder Kurvenobjekts"
    ),
    "Along the normal of the plane that the stroke was drawn in": (
        "Entlang der Normalen der Ebene, in der der Strich gezeichnet wurde"
    ),
    "Along the world's X axis; left and right are as in the right view": (
        "Entlang der X-Achse der Welt; links und rechts wie in der Ansicht von rechts"
    ),
    "Along the world's Y axis; left and right are as in the front view": (
        "Entlang der Y-Achse der Welt; links und rechts wie in der Ansicht von vorn"
    ),
    "Along the world's Z axis; left and right are as in the top view": (
        "Entlang der Z-Achse der Welt; links und rechts wie in der Ansicht von oben"
    ),
    "As the view sees it; without a view, along the normal of the stroke's plane": (
        "Wie die Ansicht es sieht; ohne Ansicht entlang der Normalen der Ebene des Strichs"
    ),
    "Both": "Beide",
    "Both pieces stay in the object, not joined": "Beide Stücke bleiben im Objekt, ohne Verbindung",
    "Both sides": "Beide Seiten",
    "Bulging with the slope and the curvature of the model": (
        "Gewölbt mit der Neigung und der Krümmung des Modells"
    ),
    "Bulging with the slope of the model": "Gewölbt mit der Neigung des Modells",
    "Cap": "Deckel",
    "Cap Material": "Material der Deckel",
    "Close the pieces where they were cut": "Die Stücke schließen, wo sie geschnitten wurden",
    "Cut & Cap": "Schneiden und schließen",
    "Cut & Cap along Stroke": "Am Strich schneiden und schließen",
    "Cut along Stroke": "Am Strich schneiden",
    "Continue the ends of the stroke straight on through everything; otherwise only as far as the part of the mesh "
    "that the stroke crosses": (
        "Die Enden des Strichs geradeaus durch alles fortsetzen; sonst nur so weit wie der Teil des Mesh, den der "
        "Strich quert"
    ),
    "Cut the selected meshes along a stroke and close them with regular patches of triangles or quads": (
        "Die ausgewählten Meshes an einem Strich schneiden und mit regelmäßigen Flicken aus Dreiecken oder Vierecken "
        "schließen"
    ),
    "Extend Ends": "Enden verlängern",
    "Direction": "Richtung",
    "Direction that the stroke is swept along, through the model": (
        "Richtung, in der der Strich durch das Modell gezogen wird"
    ),
    "Draw Cut": "Schnitt zeichnen",
    "Draw Cut & Cap": "Schnitt zeichnen und schließen",
    "Drawn": "Gezeichnet",
    "Gap": "Spalt",
    "Give the caps a material slot of their own": "Den Deckeln einen eigenen Materialslot geben",
    "In world space": "Im Raum der Welt",
    "Keep": "Behalten",
    "Largest gap between the ends of a stroke that is closed, relative to the stroke": (
        "Größte Lücke zwischen den Enden eines Strichs, die geschlossen wird, im Verhältnis zum Strich"
    ),
    "Left": "Links",
    "Length of the edges along the cut, which makes even caps; 0 cuts exactly along the stroke and leaves the "
    "edges as the mesh divides them": (
        "Länge der Kanten am Schnitt, für gleichmäßige Deckel; 0 schneidet genau am Strich und lässt die Kanten, wie "
        "das Netz sie teilt"
    ),
    "Location": "Ort",
    "Material": "Material",
    "Name of the material for caps; empty for an empty slot": (
        "Name des Materials für Deckel; leer für einen leeren Slot"
    ),
    "Number of the stroke to cut along; 0 for the selected one, or else the last one": (
        "Nummer des Strichs, an dem geschnitten wird; 0 für den ausgewählten, sonst den letzten"
    ),
    "On the surface that the stroke swept": "Auf der Fläche, die der Strich überstrichen hat",
    "One Object": "Ein Objekt",
    "Pieces": "Stücke",
    "Right": "Rechts",
    "Selected Stroke": "Ausgewählter Strich",
    "Shape of the caps": "Form der Deckel",
    "Stroke": "Strich",
    "Stroke Plane": "Ebene des Strichs",
    "The larger piece stays in the object, the other gets one of its own": (
        "Das größere Stück bleibt im Objekt, das andere bekommt ein eigenes"
    ),
    "Two Objects": "Zwei Objekte",
    "What becomes of the two sides": "Was aus den beiden Seiten wird",
    "What is on the left of the stroke as it was drawn, or inside a closed one": (
        "Was links vom Strich liegt, so wie er gezeichnet wurde, oder in einem geschlossenen"
    ),
    "What is on the right of the stroke as it was drawn, or outside a closed one": (
        "Was rechts vom Strich liegt, so wie er gezeichnet wurde, oder außerhalb eines geschlossenen"
    ),
    "Where the cut runs": "Wo der Schnitt verläuft",
    "Which side of the stroke is kept": "Welche Seite des Strichs behalten wird",
    "Width of what is taken away along the cut": "Breite dessen, was am Schnitt weggenommen wird",
    # Joining loops
    "Grid Bridge": "Schleifen mit Gitter verbinden",
    "How the tube or patch continues the surfaces at the loops": (
        "Wie die Röhre oder der Flicken die Flächen an den Schleifen fortsetzt"
    ),
    "Join two selected loops by a regular tube, or more by one smooth patch, whatever their numbers of edges": (
        "Zwei ausgewählte Schleifen durch eine regelmäßige Röhre verbinden, oder mehr durch einen glatten Flicken, wie viele "
        "Kanten sie auch haben"
    ),
    "Rows": "Reihen",
    "Loops": "Schleifen",
    "How three loops or more are joined": "Wie drei oder mehr Schleifen verbunden werden",
    "By one patch; where two look away from each other, as both ends of a pipe do, in pairs": (
        "Durch einen Flicken; wo zwei voneinander weg schauen, wie die beiden Enden eines Rohrs, paarweise"
    ),
    "One Patch": "Ein Flicken",
    "All by one patch": "Alle durch einen Flicken",
    "Pairs": "Paare",
    "Two by two, by tubes: the nearest that face each other first": (
        "Je zwei durch Röhren: die nächsten, die einander zugewandt sind, zuerst"
    ),
    "Rows of faces between two loops; 0 for as many as the lengths of the edges ask for": (
        "Reihen von Flächen zwischen zwei Schleifen; 0 für so viele, wie zu den Längen der Kanten passen"
    ),
    "Straight from loop to loop": "Gerade von Schleife zu Schleife",
    "Turn of one of two loops against the other, from where they fit best": (
        "Drehung der einen von zwei Schleifen gegen die andere, von dort, wo sie am besten passen"
    ),
    "Twist": "Verdrehung",
    # Joining bodies
    "Blend Width": "Übergangsbreite",
    "Edge lengths to each side of the line where two parts meet that become a smooth transition; 0 keeps the crease": (
        "Kantenlängen zu beiden Seiten der Linie, an der sich zwei Teile treffen, die ein weicher Übergang werden; 0 behält "
        "die Falte"
    ),
    "Grid Join": "Mit Gitter zusammenführen",
    "Join the selected meshes to one closed body in the active object, blended where they meet": (
        "Die ausgewählten Meshes zu einem geschlossenen Körper im aktiven Objekt zusammenführen, mit weichen Übergängen"
    ),
    "Join Overlapping Strokes": "Überlappende Striche zusammenführen",
    "Layer Depth": "Tiefe der Ebenen",
    "Make one object of all bodies, joined with smooth transitions where they overlap; upper layers lie before lower ones": (
        "Aus allen Körpern ein Objekt machen, mit weichen Übergängen, wo sie sich überlappen; obere Ebenen liegen vor unteren"
    ),
    "How far bodies of a layer stand out of those of the layers below, relative to half their thickness": (
        "Wie weit Körper einer Ebene aus denen der Ebenen darunter herausragen, im Verhältnis zu ihrer halben Dicke"
    ),
    "Apply Join": "Zusammenführen anwenden",
    "Follow the Parts": "Den Teilen folgen",
    "Hide Parts": "Teile verbergen",
    "Joined Body": "Zusammengeführter Körper",
    "Let the body follow where live bodies are joined, or parts are kept: it is joined anew when one of them changes": (
        "Den Körper folgen lassen, wo lebende Körper zusammengeführt oder Teile behalten werden: er wird neu zusammengeführt, "
        "wenn sich eines ändert"
    ),
    "Make a plain mesh of the active joined body; its hidden parts are removed": (
        "Aus dem aktiven zusammengeführten Körper ein einfaches Mesh machen; seine verborgenen Teile werden entfernt"
    ),
    "Show Parts": "Teile zeigen",
    "Show the parts again instead of removing them": "Die Teile wieder zeigen, statt sie zu entfernen",
    "Show the parts of the active joined body to be edited and hide the body, or the other way round": (
        "Die Teile des aktiven zusammengeführten Körpers zum Bearbeiten zeigen und den Körper verbergen, oder umgekehrt"
    ),
    "1: the middle of the part is on the surface of the body, as the view saw it that it was drawn in; 0: it goes through the "
    "middle of the body; -1: it is behind": (
        "1: die Mitte des Teils ist auf der Oberfläche des Körpers, wie ihn die Ansicht sah, in der er gezeichnet wurde; 0: er "
        "geht durch die Mitte des Körpers; -1: er ist dahinter"
    ),
    "Join the mirror image of the part, too, across the X axis of the joined body; it follows the same stroke": (
        "Auch das Spiegelbild des Teils zusammenführen, über die X-Achse des zusammengeführten Körpers; es folgt demselben Strich"
    ),
    "Part Depth": "Tiefe des Teils",
    "Parts": "Teile",
    "Pick Part": "Teil wählen",
    "Show a part of the joined body over it and select it, to be moved, edited or deleted; the body follows": (
        "Einen Teil des zusammengeführten Körpers über ihm zeigen und auswählen, um ihn zu verschieben, zu bearbeiten oder zu "
        "löschen; der Körper folgt"
    ),
    "Split Off Part": "Teil abtrennen",
    "Take the active part out of the joined body; it is a body of its own again, and so is its twin": (
        "Den aktiven Teil aus dem zusammengeführten Körper nehmen; er ist wieder ein eigener Körper, ebenso sein Zwilling"
    ),
    "Keep Parts": "Teile behalten",
    "Keep the selected objects, hidden, and make the body a new object; without, they become it": (
        "Die ausgewählten Objekte verborgen behalten und den Körper zu einem neuen Objekt machen; ohne dies werden sie er"
    ),
    "Refuse joints that meet themselves or the parts, instead of warning of them": (
        "Übergänge ablehnen, die sich selbst oder die Teile treffen, statt davor zu warnen"
    ),
    "Strict": "Streng",
    "The edge length that Blend Width counts in; 0 for that of each part": (
        "Die Kantenlänge, in der die Übergangsbreite zählt; 0 für die jedes Teils"
    ),
    # Filling holes
    "All holes that are not hidden, up to a number of edges": (
        "Alle Löcher, die nicht ausgeblendet sind, bis zu einer Anzahl von Kanten"
    ),
    "Close Chains": "Ketten schließen",
    "Close selected chains of edges by a straight edge": (
        "Ausgewählte Ketten von Kanten durch eine gerade Kante schließen"
    ),
    "Continue hard edges of the surroundings (bent by more than 30 degrees, or marked sharp) to where they meet, as at "
    "a corner of a cube": (
        "Harte Kanten der Umgebung (um mehr als 30 Grad geknickt oder als scharf markiert) fortsetzen, bis sie sich "
        "treffen, wie an einer Würfelecke"
    ),
    "Curvature": "Krümmung",
    "Holes with more edges are left open; 0 fills holes of any size. The outer border of a flat sheet is no hole": (
        "Löcher mit mehr Kanten bleiben offen; 0 füllt Löcher jeder Größe. Der äußere Rand eines flachen Blatts ist kein Loch"
    ),
    "How a patch continues the surface around it": "Wie ein Flicken die Fläche um ihn herum fortsetzt",
    "Keep Hard Edges": "Harte Kanten erhalten",
    "Quads, four around almost every vertex, that go on from those around; one triangle where the number of edges "
    "is odd": (
        "Vierecke, vier um fast jeden Punkt, die die umgebenden fortsetzen; ein Dreieck, wo die Zahl der Kanten "
        "ungerade ist"
    ),
    "What caps are made of": "Woraus Deckel bestehen",
    "What patches are made of": "Woraus Flicken bestehen",
    "Max Edges": "Höchstens Kanten",
    "Selected loops of open edges, and the whole holes that single selected edges or vertices lie on": (
        "Ausgewählte Schleifen offener Kanten, und ganze Löcher, an denen einzelne ausgewählte Kanten oder Punkte liegen"
    ),
    "Smoothness": "Glätte",
    "Stretched into the hole like a soap film": "In das Loch gespannt wie eine Seifenhaut",
    "Tangent": "Tangential",
    "Which holes are filled": "Welche Löcher gefüllt werden",
    "With the slope and the curvature of the surface": "Mit Neigung und Krümmung der Fläche",
    "With the slope of the surface": "Mit der Neigung der Fläche",
}

CONTEXT = "GridMesh"
EXTENSION = __package__.rpartition(".")[0]
"""Of the names of options."""

LANGUAGES: dict[str, dict[str, str]] = {"de_DE": GERMAN | GERMAN_MESSAGES}


def table() -> dict[str, dict[tuple[str, str], str]]:
    """Translations as Blender wants them: operators' names have a context of their own, and so have our options."""
    return {
        locale: {
            (context, text): said
            for text, said in texts.items()
            for context in ("*", "Operator", CONTEXT)
            if "{}" not in text  # templates are found by `telling`
        }
        for locale, texts in LANGUAGES.items()
    }


def claim(cls: type) -> None:
    """Give the options of a class, before it is registered, the context of our translations.

    Without it Blender's own translation comes first, and that means something else: its "Triangles" is a verb in German.
    """
    for base in cls.__mro__:
        if not base.__module__.startswith(EXTENSION):
            continue
        # In modules with postponed evaluation options are text until somebody asks for them.
        base.__annotations__ = inspect.get_annotations(base, eval_str=True)
        for option in base.__annotations__.values():
            keywords = getattr(option, "keywords", None)
            if keywords is not None:
                keywords.setdefault("translation_context", CONTEXT)


def register() -> None:
    """Give Blender the translations."""
    bpy.app.translations.register(EXTENSION, table())


def unregister() -> None:
    """Take them back; Blender does not mind if it has none."""
    bpy.app.translations.unregister(EXTENSION)
